#include "packs/scene_files.h"

#include "base/file.h"
#include "io/gltf.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTilePattern = "<UDIM>";

std::vector<SceneFile::Part> tilesOf(const fs::path& pattern, std::size_t at) {
    std::vector<SceneFile::Part> tiles;
    const std::string text = pattern.string();
    std::error_code error;
    for (int tile = 1001; tile < 2000; ++tile) {
        const std::string number = std::to_string(tile);
        const fs::path path = std::string(text).replace(at, kTilePattern.size(), number);
        if (fs::is_regular_file(path, error)) tiles.push_back({number, path});
    }
    return tiles;
}

std::vector<SceneFile::Part> filePartsOf(const fs::path& path) {
    std::error_code error;
    if (!fs::exists(path, error))
        if (const std::size_t at = path.string().find(kTilePattern); at != std::string::npos) return tilesOf(path, at);
    std::vector<SceneFile::Part> parts{{{}, path}};
    std::string head(256, '\0');
    head.resize(RegularFile(path.string()).readAt(0, head));
    if (!looksLikeGltf(head)) return parts;
    std::vector<std::string> buffers = gltfBufferFiles(path.string());
    std::ranges::sort(buffers);
    buffers.erase(std::unique(buffers.begin(), buffers.end()), buffers.end());
    for (std::string& buffer : buffers)
        if (fs::path file = path.parent_path() / buffer; fs::is_regular_file(file, error))
            parts.push_back({std::move(buffer), std::move(file)});
    return parts;
}

// With the pictures and libraries that a model's materials are in.
std::vector<SceneFile::Part> partsOf(const fs::path& path, const std::set<fs::path>& beside) {
    std::vector<SceneFile::Part> parts = filePartsOf(path);
    const auto folder = fs::absolute(path).parent_path();
    for (const fs::path& file : beside) {
        const auto real = fs::absolute(file).lexically_normal();
        const bool known = std::ranges::any_of(
            parts, [&](const SceneFile::Part& part) { return fs::absolute(part.path).lexically_normal() == real; });
        if (!known) parts.push_back({real.lexically_relative(folder.lexically_normal()).generic_string(), file});
    }
    return parts;
}

} // namespace

std::vector<SceneFile> filesOf(const schema::SceneTree& tree) {
    std::vector<SceneFile> files;
    if (!tree.namedFiles) return files;
    std::set<std::pair<FileId, std::uint32_t>> seen;
    std::map<fs::path, std::vector<SceneFile::Part>> known; // a thousand shapes may name one file
    std::map<fs::path, std::set<fs::path>> beside;          // and some of them take its materials
    for (const schema::NamedFile& named : *tree.namedFiles)
        beside[named.path].insert(named.beside.begin(), named.beside.end());
    for (const schema::NamedFile& named : *tree.namedFiles)
        if (seen.emplace(named.span.file, named.span.begin).second) {
            const auto [parts, fresh] = known.try_emplace(named.path);
            if (fresh) parts->second = partsOf(named.path, beside[named.path]);
            if (!parts->second.empty()) files.push_back({named, parts->second});
        }
    return files;
}

} // namespace abbe
