#include "exchange/importer/importer.h"

#include "base/file.h"
#include "exchange/gltf/gltf_import.h"
#include "exchange/mitsuba/mitsuba_import.h"
#include "exchange/obj/obj_import.h"
#include "exchange/pbrt/pbrt_import.h"
#include "exchange/usd/usd_import.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr std::size_t kHeadBytes = 16384; // by which formats are known; comments may stand before

// One entry for each format. Another one is a line here.
constexpr ImportFormat kImportFormats[] = {
    {"mitsuba", "a scene of Mitsuba (XML)", isMitsubaScene, importMitsuba},
    {"pbrt", "a scene of pbrt-v4", isPbrtScene, importPbrt},
    {"gltf", "a glTF 2.0 scene", isGltfScene, importGltf},
    {"obj", "a Wavefront OBJ model", isObjModel, importObj},
    {"usd", "an OpenUSD stage", isUsdStage, nullptr, importUsd},
};

std::string headOf(const std::filesystem::path& path) {
    RegularFile file(path.string());
    std::string head(kHeadBytes, '\0');
    head.resize(file.good() ? file.readAt(0, head) : 0);
    return head;
}

} // namespace

std::span<const ImportFormat> importFormats() { return kImportFormats; }

const ImportFormat* importFormat(const std::filesystem::path& path) {
    const std::string head = headOf(path);
    const auto found =
        std::ranges::find_if(kImportFormats, [&](const ImportFormat& format) { return format.recognises(path, head); });
    return head.empty() || found == std::end(kImportFormats) ? nullptr : found;
}

std::optional<std::string> importScene(const ImportFormat& format, const std::filesystem::path& foreign,
                                       const std::filesystem::path& scene, SourceMap& sources, Diagnostics& diagnostics,
                                       const ImportChoice& choice) {
    if (format.make) return format.make(foreign, scene, choice, sources, diagnostics);
    SideFiles files(scene);
    Import import{sources, diagnostics, files, {}};
    const std::size_t before = diagnostics.errorCount();
    format.read(foreign, import);
    if (diagnostics.errorCount() > before) return std::nullopt;
    SceneNode header("scene");
    header.number(1).key("length", "m");
    header.remark(fmt::format("Imported from {}, {}.", foreign.filename().string(), format.what));
    import.nodes.push_front(std::move(header));
    return printScene(std::move(import.nodes));
}

bool isModel(const std::filesystem::path& path) {
    const std::string head = headOf(path);
    return isGltfScene(path, head) || isObjModel(path, head);
}

std::optional<ModelText> importModel(const std::filesystem::path& file, const std::filesystem::path& scene,
                                     ModelUse use, SourceMap& sources, Diagnostics& diagnostics) {
    SideFiles files(scene);
    Import import{sources, diagnostics, files, {}, std::move(use)};
    const std::size_t before = diagnostics.errorCount();
    const bool gltf = isGltfScene(file, headOf(file));
    (gltf ? importGltf : importObj)(file, import);
    if (diagnostics.errorCount() > before) return std::nullopt;
    return ModelText{printScene(std::move(import.nodes)), files.read(), gltf};
}

} // namespace abbe::exchange
