#include "exchange/mitsuba/media.h"
#include "exchange/shared/vdb_writer.h"
#include "io/file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <numeric>

namespace abbe::exchange {

namespace {

struct VolGrid {
    std::array<int, 3> counts{};
    std::array<float, 6> bounds{}; // of the file, which only `use_grid_bbox` asks for
    std::vector<float> values;     // x counts fastest; the mean of several channels
};

constexpr int kMostVoxelsAside = 4096;

// "VOL", version 3, encoding 1 (single precision), three counts, channels, a box, values [Mitsuba 3 documentation,
// "Grid-based volume data source"].
std::optional<VolGrid> readVolGrid(const std::string& path, std::string& fault) {
    const std::string bytes = readFileBytes(path);
    constexpr std::size_t kHeader = 48;
    std::array<std::int32_t, 5> numbers{};
    if (bytes.size() < kHeader || !bytes.starts_with("VOL\3")) {
        fault = "it is no grid of voxels (VOL, version 3)";
        return std::nullopt;
    }
    std::memcpy(numbers.data(), bytes.data() + 4, sizeof numbers);
    VolGrid grid;
    std::memcpy(grid.bounds.data(), bytes.data() + 24, sizeof grid.bounds);
    const auto channels = static_cast<std::size_t>(std::clamp(numbers[4], 0, 6));
    std::size_t count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        grid.counts[i] = numbers[i + 1];
        if (grid.counts[i] < 1 || grid.counts[i] > kMostVoxelsAside) fault = "its size is out of range";
        count *= static_cast<std::size_t>(std::clamp(grid.counts[i], 1, kMostVoxelsAside));
    }
    if (numbers[0] != 1 || channels == 0) fault = "only values in single precision are read";
    if (fault.empty() && (bytes.size() - kHeader) / 4 / channels < count) fault = "it ends too early";
    if (!fault.empty()) return std::nullopt;
    grid.values.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        float sum = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            float value = 0;
            std::memcpy(&value, bytes.data() + kHeader + 4 * (i * channels + c), 4);
            sum += value;
        }
        grid.values[i] = std::isfinite(sum) && sum > 0 ? sum / static_cast<float>(channels) : 0;
    }
    return grid;
}

std::optional<VolGrid> gridOf(const XmlObject& volume, MitsubaContext& ctx) {
    const XmlParam* const file = volume.find("filename");
    const auto path = file ? findXmlFile(ctx.scene, *file, ctx.import) : std::nullopt;
    if (!path) {
        if (!file) ctx.import.diagnostics.error("E0802", volume.span, "a grid needs a `filename`");
        return std::nullopt;
    }
    std::string fault;
    auto grid = readVolGrid(path->string(), fault);
    if (!grid) ctx.import.diagnostics.error("E0402", file->span, fmt::format("`{}`: {}", path->string(), fault));
    return grid;
}

// Where voxel centres are: (i + 0.5) / n of the unit cube, or of the file's box.
Transform gridPlace(const XmlObject& volume, const VolGrid& grid, MitsubaContext& ctx) {
    Transform map = Transform::translate({0.5, 0.5, 0.5})
                        .then(Transform::scale({1.0 / grid.counts[0], 1.0 / grid.counts[1], 1.0 / grid.counts[2]}));
    if (mitsubaFlag(volume, "use_grid_bbox", false, ctx.import)) {
        const auto& b = grid.bounds;
        map = map.then(Transform::scale({b[3] - b[0], b[4] - b[1], b[5] - b[2]}))
                  .then(Transform::translate({b[0], b[1], b[2]}));
    }
    return map.then(mitsubaTransform(volume));
}

void writeGridAlbedo(SceneNode& node, const XmlObject& medium, MitsubaContext& ctx) {
    const XmlParam* const albedo = medium.find("albedo");
    const XmlParam* const constant = constantOf(albedo);
    if (!albedo)
        node.child("albedo").number(0.75);
    else if (!constant)
        node.child("albedo").number(std::clamp(meanOfGrid(*albedo->object, ctx), 0.0, 1.0));
    else if (const auto spectrum = readSpectrum(*constant, SpectrumUse::reflectance, ctx))
        writeSpectrum(node.child("albedo"), *spectrum, SpectrumUse::reflectance, constant->span, ctx);
}

} // namespace

double meanOfGrid(const XmlObject& volume, MitsubaContext& ctx) {
    const auto grid = gridOf(volume, ctx);
    mitsubaIgnore(volume, {"filter_type", "wrap_mode", "raw", "accel", "max_value", "use_grid_bbox", "to_world"});
    if (!grid) return 1;
    ctx.import.approximated(nullptr, volume.span, "a grid of colours", "by its mean, in grey");
    return std::accumulate(grid->values.begin(), grid->values.end(), 0.0) / static_cast<double>(grid->values.size());
}

const SceneNode* gridVolumeOf(const XmlObject& shape, MitsubaContext& ctx) {
    const XmlParam* const inside = shape.find("interior");
    if (!ctx.seesMedia || !inside || !inside->object || inside->object->plugin != "heterogeneous") return nullptr;
    const XmlObject& medium = *inside->object;
    const XmlParam* const density = medium.find("sigma_t");
    if (!density || constantOf(density) || !density->object || density->object->plugin != "gridvolume") return nullptr;
    if (const auto known = ctx.volumes.find(&medium); known != ctx.volumes.end()) return &known->second;
    SceneNode node("volume");
    node.name(ctx.mediumNames.take(medium.id, "volume"));
    const XmlObject& volume = *density->object;
    if (const auto grid = gridOf(volume, ctx)) {
        const VdbGrid voxels{"density", grid->values};
        node.word("vdb").text(ctx.import.files.write(medium.id.empty() ? "volume" : medium.id, "vdb",
                                                     vdbFile(grid->counts, std::span(&voxels, 1))));
        node.child("extinction").number(mitsubaNumber(medium, "scale", 1, ctx.import)).word("per-m");
        writeGridAlbedo(node, medium, ctx);
        if (const auto phases = medium.objects("phase"); !phases.empty())
            writePhase(node.child("phase"), *phases[0], 0, ctx);
        writeTransform(node, gridPlace(volume, *grid, ctx));
        ctx.import.approximated(
            &node, medium.span, "the outline of a grid",
            "voxels fill their grid, and not the shape around it, and fade over half a voxel beyond its ends");
        mitsubaIgnore(volume, {"filter_type", "wrap_mode", "raw", "accel", "max_value"});
        mitsubaIgnore(medium, {"sample_emitters", "has_spectral_extinction", "majorant_resolution_factor", "id"});
        if (medium.find("emission")) ctx.import.leftOut(&node, medium.span, "`emission` of voxels", "it is not read");
        warnOfUnused(volume, ctx.import);
        warnOfUnused(medium, ctx.import);
        ctx.import.nodes.push_back(node);
    }
    return &ctx.volumes.emplace(&medium, std::move(node)).first->second;
}

} // namespace abbe::exchange
