// Scenes of other programs that a command is given in place of a scene file, and models whose materials shapes of a
// scene take: imported into folders of the cache.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"
#include "schema/scene_tree.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace abbe {

class FileReach;
class FolderUse;
struct MeshParams;
namespace exchange {
struct ImportFormat;
struct ImportChoice;
} // namespace exchange

// A private folder (mode 0700) for as long as the object lives, that this process alone uses: importing is quick, and
// what is imported may have changed since the last time. Folders that a killed process left behind are removed a day
// later.
class ImportFolder {
  public:
    // Throws IoError if it cannot be made.
    ImportFolder();
    ~ImportFolder();
    ImportFolder(const ImportFolder&) = delete;
    ImportFolder& operator=(const ImportFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    std::unique_ptr<const FolderUse> use_;
};

// The scene on disk for as long as the object lives.
class ImportedScene {
  public:
    // Throws IoError if it cannot be written.
    ImportedScene(const exchange::ImportFormat&, const std::filesystem::path& foreign, const exchange::ImportChoice&,
                  SourceMap&, Diagnostics&);

    // The scene's text, or nothing: what is wrong is in the diagnostics then.
    const std::optional<std::string>& text() const { return text_; }
    const std::filesystem::path& scenePath() const { return scene_; }
    // Whether the text is that of one frame, so that another one is imported anew.
    bool isOfFrame() const { return ofFrame_; }

  private:
    ImportFolder folder_;
    std::filesystem::path scene_;
    std::optional<std::string> text_;
    bool ofFrame_ = false;
};

// Models with their materials: every `shape mesh "a.glb" { materials on }` becomes a group of shapes, whose names, as
// those of materials and textures, begin with the shape's: `chair/wood`. What they are made of is on disk for as long
// as the object lives.
class PlacedModels {
  public:
    PlacedModels(SourceMap& sources, const schema::TypeTable& types, Diagnostics& diagnostics)
        : sources_(sources), types_(types), diagnostics_(diagnostics) {}
    ~PlacedModels();

    // Changes the definitions of a scene whose names have not been checked. Faults of a model stand at the shape that
    // names it. Throws IoError if its files cannot be written.
    void place(schema::SceneTree&);

  private:
    void walk(std::vector<schema::Definition>&);
    void replace(schema::Definition& shape);
    bool mayHaveMaterials(const schema::Definition& shape);
    std::vector<schema::Definition> read(const schema::Definition& shape, const MeshParams&);
    std::string freePrefix(const std::string& wish);

    SourceMap& sources_;
    const schema::TypeTable& types_;
    Diagnostics& diagnostics_;
    std::unique_ptr<const ImportFolder> folder_; // of all of them
    std::unique_ptr<const FileReach> reach_;     // of what is in it
    schema::SceneTree* tree_ = nullptr;
    std::set<std::string> names_;              // of the scene
    std::vector<schema::Definition> referred_; // materials, textures and objects of the models
    std::size_t count_ = 0;                    // of models
};

// $XDG_CACHE_HOME/abbe/imports, else ~/.cache/abbe/imports; without either a folder in that of temporary files.
std::filesystem::path importCacheDirectory();

} // namespace abbe
