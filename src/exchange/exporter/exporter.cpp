#include "exchange/exporter/exporter.h"

#include "exchange/gltf_export/gltf_writer.h"
#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/pbrt_export/pbrt_writer.h"
#include "exchange/usd_export/usd_writer.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// One entry for each format. Another one is a line here.
constexpr ExportFormat kExportFormats[] = {
    {"mitsuba", "Mitsuba", ".xml", exportMitsuba},
    {"pbrt", "pbrt", ".pbrt", exportPbrt},
    {"gltf", "glTF", ".glb", exportGltf},
    {"usda", "OpenUSD", ".usda", exportUsd, true},
};

} // namespace

std::span<const ExportFormat> exportFormats() { return kExportFormats; }

const ExportFormat* findExportFormat(std::string_view name) {
    const auto found = std::ranges::find(kExportFormats, name, &ExportFormat::name);
    return found == std::end(kExportFormats) ? nullptr : found;
}

std::string exportScene(const ExportFormat& format, const StatedScene& scene, const std::filesystem::path& target,
                        Diagnostics& diagnostics) {
    // A folder of its own: an imported scene of the same name may read what is in its folder.
    SideFiles files(target.parent_path() / fmt::format("{}-{}.x", target.stem().string(), format.name));
    Export to{scene, diagnostics, files, format.title};
    return format.write(to);
}

} // namespace abbe::exchange
