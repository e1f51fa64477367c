// Scenes of other programs that a command is given in place of a scene file: imported into a folder of the cache.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace abbe {

class FolderUse;
namespace exchange {
struct ImportFormat;
}

// The scene on disk for as long as the object lives, in a private folder (mode 0700) that this process alone uses:
// importing is quick, and what the foreign scene reads may have changed since the last time. Folders that a killed
// process left behind are removed a day later.
class ImportedScene {
  public:
    // Throws IoError if it cannot be written.
    ImportedScene(const exchange::ImportFormat&, const std::filesystem::path& foreign, SourceMap&, Diagnostics&);
    ~ImportedScene();
    ImportedScene(const ImportedScene&) = delete;
    ImportedScene& operator=(const ImportedScene&) = delete;

    // The scene's text, or nothing: what is wrong is in the diagnostics then.
    const std::optional<std::string>& text() const { return text_; }
    const std::filesystem::path& scenePath() const { return scene_; }

  private:
    std::filesystem::path folder_, scene_;
    std::unique_ptr<const FolderUse> use_;
    std::optional<std::string> text_;
};

// $XDG_CACHE_HOME/abbe/imports, else ~/.cache/abbe/imports; without either a folder in that of temporary files.
std::filesystem::path importCacheDirectory();

} // namespace abbe
