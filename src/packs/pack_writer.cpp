#include "base/file.h"
#include "io/file.h"
#include "packs/manifest.h"
#include "packs/pack_scene.h"
#include "packs/sha256.h"
#include "packs/zip_file.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCopied = std::size_t{1} << 20; // bytes at a time

void readPortions(const std::string& path, const std::function<void(std::span<const char>)>& sink) {
    RegularFile file(path);
    std::vector<char> buffer(kCopied);
    for (std::uint64_t at = 0; file.good() && at < file.size();) {
        const std::size_t got = file.readAt(at, buffer);
        if (got == 0) break;
        sink({buffer.data(), got});
        at += got;
    }
    if (!file.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file.why()));
}

// Text is worth deflating; pictures, volumes and binary meshes hardly are, and are many times larger.
bool isText(const std::string& name) {
    constexpr std::string_view endings[] = {".scene", ".json", ".gltf", ".obj", ".ies", ".csv", ".txt", ".spd", ".dat"};
    return std::ranges::any_of(endings, [&](std::string_view ending) { return name.ends_with(ending); });
}

// All files by name; the manifest, which lists them, comes first.
std::vector<ZipSource> sourcesOf(const ScenePack& pack, const std::string& program) {
    std::vector<ZipSource> sources;
    Sha256 hash;
    hash.add(pack.sceneText);
    sources.push_back(
        {pack.sceneName, pack.sceneText, {}, pack.sceneText.size(), hash.digits(), isText(pack.sceneName)});
    for (const ScenePack::File& file : pack.files) {
        ZipSource source{file.name, {}, file.path.string(), 0, {}, isText(file.name)};
        Sha256 content;
        if (file.text) {
            content.add(*file.text);
            sources.push_back({file.name, *file.text, {}, file.text->size(), content.digits(), isText(file.name)});
            continue;
        }
        readPortions(source.path, [&](std::span<const char> bytes) {
            content.add(bytes);
            source.bytes += bytes.size();
        });
        source.sha256 = content.digits();
        sources.push_back(std::move(source));
    }
    if (sources.size() > kMostPackedFiles)
        throw IoError(
            fmt::format("a pack has at most {} files, and this scene has {}", kMostPackedFiles, sources.size()));
    std::ranges::sort(sources, {}, &ZipSource::name);
    PackManifest manifest{program, pack.sceneName, {}};
    for (const ZipSource& s : sources) manifest.files.push_back({s.name, s.bytes, s.sha256});
    std::string text = manifestText(manifest);
    sources.insert(sources.begin(), {kManifestName, std::move(text), {}, 0, {}, true});
    return sources;
}

std::uint64_t bytesOf(const std::vector<ZipSource>& sources) {
    std::uint64_t sum = 0;
    for (const ZipSource& source : sources) sum += source.bytes;
    return sum;
}

void writeInto(const fs::path& folder, const ZipSource& source) {
    const fs::path target = folder / source.name;
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    AtomicFile file(target.string());
    Sha256 hash;
    if (source.path.empty())
        file.write(source.text);
    else
        readPortions(source.path, [&](std::span<const char> bytes) {
            file.write(bytes);
            hash.add(bytes);
        });
    if (!source.path.empty() && hash.digits() != source.sha256)
        throw IoError(fmt::format("`{}` was changed while it was packed", source.path));
    file.commit();
}

} // namespace

std::uint64_t writePack(const ScenePack& pack, const std::string& path, const std::string& program) {
    const std::vector<ZipSource> sources = sourcesOf(pack, program);
    writeZip(path, sources);
    return bytesOf(sources);
}

std::uint64_t writePackFolder(const ScenePack& pack, const std::string& folder, const std::string& program) {
    std::error_code error;
    if (fs::exists(folder, error) && !(fs::is_directory(folder, error) && fs::is_empty(folder, error)))
        throw IoError(fmt::format("cannot write to `{}`: it is there already, and is not an empty folder", folder));
    const std::vector<ZipSource> sources = sourcesOf(pack, program);
    fs::create_directories(folder, error);
    for (const ZipSource& source : sources) writeInto(folder, source);
    return bytesOf(sources);
}

} // namespace abbe
