// Parse and check: from the words of the command line to the meaning of a scene file.
#pragma once

#include "app/imported_scene.h"
#include "app/program_end.h"
#include "base/diagnostic.h"
#include "base/enclosure.h"
#include "base/file.h"
#include "base/source.h"
#include "packs/unpacked.h"
#include "schema/scene_tree.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

// What `--variant` and `--set` change in a scene, and where `--search` finds files of it, in their order.
struct LayerChoice {
    std::vector<std::string> variants;    // names
    std::vector<std::string> sets;        // "kind.name.property=value"
    std::vector<std::string> search = {}; // folders in which the scene may read (base/enclosure.h)

    bool operator==(const LayerChoice&) const = default;
};

// The scene of a command line.
struct SceneInput {
    std::string path;
    std::vector<std::string> defines; // "name=value" of -D
    // The text comes from there; `path` is what it is called, and says where its files are.
    bool fromStandardInput = false;
    // This moment of an animation, and not the scene's own: the one place where a frame is chosen. The parameter
    // `frame` has its number, if the scene has that parameter, and the camera's time is frame / fps later.
    std::optional<int> frame = {};
    LayerChoice layers = {};
    // Of another program's scene, where its moments hang on the camera; empty: its own choice.
    std::string camera = {};
    // The text, where an editor holds it; `path` is what it is called then, too.
    std::optional<std::string> text = {};
};

// The flags that choose the same of a scene again, with their values: `-D`, `--variant`, `--set`, `--search`.
std::vector<std::pair<const char*, std::string>> flagsOf(const SceneInput&);

// A scene file that was read and resolved. Not movable: the tree refers to sources and types.
struct LoadedScene {
    LoadedScene() = default;
    LoadedScene(const LoadedScene&) = delete;
    LoadedScene& operator=(const LoadedScene&) = delete;

    // What the scene may name while it is read and built: that of its own folder, and of one that it was imported to.
    std::unique_ptr<const FileReach> reach, importReach;
    SourceMap sources;
    schema::TypeTable types;
    schema::SceneTree tree;
    Diagnostics diagnostics;
    std::unique_ptr<const UnpackedPack> pack;    // that the scene is in, if it is in one
    std::unique_ptr<const ImportedScene> import; // that the scene was made by, if it is another program's
    std::unique_ptr<PlacedModels> models;        // that shapes of the scene take with their materials
    FileId text = FileId::none;                  // the scene's own, of `sources`
    bool readable = false;                       // the file itself could be read
    // Whether the text asks for the parameter `frame`, so that it means something else at each frame.
    bool asksForFrame() const;
    double parseSeconds = 0, resolveSeconds = 0; // wall clock

    // How a command ends that met these diagnostics: done without errors.
    ExitCode exitCode() const;
    // Whether frames of the scene may differ: something has keys, or asks for the parameter `frame`.
    bool changesWithFrames() const;
};

// The path may be that of a pack (docs/packing.md), which is unpacked into the cache, or of a scene of another program
// (docs/importing.md), which is imported there.
// Never null and never throws on bad input; what is wrong is in `diagnostics`.
std::unique_ptr<LoadedScene> loadScene(const SceneInput&);

// Scenes of the same text one after another, such as the frames of an animation: read again only where the file is
// another one, or the text is another one at each frame.
class SceneLoader {
  public:
    // As loadScene(). Whoever has an earlier one must be done with it: it may be the same, as it was when it was
    // loaded.
    std::shared_ptr<LoadedScene> load(const SceneInput&);
    std::size_t timesRead() const { return timesRead_; }

  private:
    bool isSame(const SceneInput&) const;

    std::shared_ptr<LoadedScene> last_;
    SceneInput input_;
    FileIdentity file_;
    Diagnostics diagnostics_; // of loading
    std::vector<schema::NamedFile> named_;
    std::size_t timesRead_ = 0;
};

} // namespace abbe
