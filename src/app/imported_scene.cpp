#include "app/imported_scene.h"

#include "base/private_folder.h"
#include "exchange/importer/importer.h"
#include "io/file.h"
#include "spectrum/upsampling_table.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr double kForgotten = 24 * 3600; // s after which a folder that nobody uses is removed

[[noreturn]] void failImport(const fs::path& path, int error) {
    throw IoError(fmt::format("cannot import to `{}`: {}", path.string(), std::strerror(error)));
}

} // namespace

fs::path importCacheDirectory() {
    if (const fs::path cache = UpsamplingTable::cacheDirectory(); !cache.empty()) return cache / "imports";
    std::error_code error;
    return fs::temp_directory_path(error) / fmt::format("abbe-imports-{}", ::geteuid());
}

ImportedScene::ImportedScene(const exchange::ImportFormat& format, const fs::path& foreign, SourceMap& sources,
                             Diagnostics& diagnostics) {
    const fs::path cache = importCacheDirectory();
    if (const int error = makePrivateFolder(cache)) failImport(cache, error);
    removeUnusedFolders(cache, kForgotten);
    std::string name = (cache / "XXXXXX").string();
    if (!::mkdtemp(name.data())) failImport(cache, errno);
    folder_ = name;
    use_ = std::make_unique<const FolderUse>(folder_);
    scene_ = folder_ / foreign.filename().replace_extension(".scene");
    text_ = exchange::importScene(format, foreign, scene_, sources, diagnostics);
}

ImportedScene::~ImportedScene() {
    std::error_code error;
    fs::remove_all(folder_, error);
    fs::remove(folder_.string() + ".lock", error);
}

} // namespace abbe
