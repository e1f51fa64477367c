// Volumes from OpenVDB files: their grids, what they emit with, how they drift.
#include "media/grid_emission.h"
#include "media/grid_medium.h"
#include "scene/medium_builder.h"
#include "volumes/vdb_file.h"

#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

namespace {

using schema::Text;

constexpr double kHottest = 1e9;       // K
constexpr double kFurthestDrift = 256; // voxels; bounds that hold so far away take a while to make

double keyOf(const std::optional<Text>& text, std::string_view name, double value) {
    if (!text) return value;
    for (const auto& [key, written] : text->keys)
        if (key == name) std::from_chars(written.data(), written.data() + written.size(), value);
    return value;
}

// The grids of a volume, in the order in which they are read.
class GridRequests {
  public:
    explicit GridRequests(const VdbParams& p) {
        add(p.density, "density", p.levelSet ? VdbUse::amountOrLevelSet : VdbUse::amount, p.file.span);
        if (p.temperature) add(p.temperature, "temperature", VdbUse::amount, p.file.span);
        if (p.flame) add(p.flame, "flame", VdbUse::amount, p.file.span);
        if (p.color) add(p.color, "Cd", VdbUse::vector, p.file.span);
        if (p.velocity) add(p.velocity, "velocity", VdbUse::vector, p.file.span);
    }

    const std::vector<VdbRequest>& list() const { return list_; }
    Digest digest(const std::string& file) const {
        DigestWriter writer("grids");
        addFile(writer, file);
        for (const VdbRequest& r : list_) writer.text(r.grid), writer.number(static_cast<int>(r.use));
        return writer.digest();
    }
    void report(const VdbFault& fault, Span file, Diagnostics& diagnostics) const {
        using Kind = VdbFault::Kind;
        const bool name = fault.kind == Kind::noGrid, ofGrid = name || fault.kind == Kind::wrongKind;
        auto& e = diagnostics.error(name ? "E0643" : "E0642", ofGrid ? spans_[fault.request] : file, fault.text,
                                    name ? "no such grid" : "cannot be used");
        if (name && !fault.names.empty()) e.help = fmt::format("the grids are {}", fmt::join(fault.names, ", "));
        if (fault.kind != Kind::wrongKind) return;
        const bool density = fault.request == 0, vector = list_[fault.request].use == VdbUse::vector;
        e.help = vector    ? "a grid of vectors is needed here; `abbe volume info FILE` tells what the file has"
                 : density ? "a grid of numbers is needed here; a level set becomes fog with `level-set on`, and "
                             "vectors are for `velocity` and `color`"
                           : "a grid of numbers is needed here; `abbe volume info FILE` tells what the file has";
    }

  private:
    void add(const std::optional<Text>& written, std::string_view usual, VdbUse use, Span file) {
        list_.push_back({written && !written->value.empty() ? written->value : std::string(usual), use, false});
        spans_.push_back(written && written->span.valid() ? written->span : file);
    }
    std::vector<VdbRequest> list_;
    std::vector<Span> spans_;
};

// Null after an error.
std::shared_ptr<const std::vector<VdbGrid>> readGrids(const Text& file, const GridRequests& requests,
                                                      Diagnostics& diagnostics) {
    auto read = readVdb(file.value, requests.list());
    if (const auto* fault = std::get_if<VdbFault>(&read)) {
        requests.report(*fault, file.span, diagnostics);
        return nullptr;
    }
    auto& grids = std::get<std::vector<VdbGrid>>(read);
    for (const VdbGrid& grid : grids)
        for (const std::string& note : grid.notes) diagnostics.warning("W0690", file.span, note, "put right");
    return std::make_shared<const std::vector<VdbGrid>>(std::move(grids));
}

ScaledGrid scaled(VdbGrid& grid, const std::optional<Text>& text) {
    return {std::move(*grid.scalar), keyOf(text, "scale", 1), keyOf(text, "offset", 0)};
}

// What was read beside the density, in the order of GridRequests.
GridExtras extrasOf(const VdbParams& params, const MediumOptics& optics, std::span<VdbGrid> grids,
                    BuildContext& scene) {
    GridExtras extras;
    std::size_t next = 0;
    if (params.temperature) extras.temperature = scaled(grids[next++], params.temperature);
    if (params.flame) extras.flame = scaled(grids[next++], params.flame);
    if (params.color) {
        VectorGrid& grid = *grids[next++].vector;
        if (const std::uint64_t count = countOutside(grid, 0, 1); count > 0)
            scene.diagnostics.warning("W0692", params.color->span,
                                      fmt::format("{} voxel{} of `{}` {} not within 0 and 1", count,
                                                  count == 1 ? "" : "s", grid.name(), count == 1 ? "is" : "are"),
                                      "nothing scatters more than all light; clamped");
        extras.color = GridExtras::Color{std::move(grid),
                                         std::make_unique<UpsamplingTable>(UpsamplingTable::loadOrBuild(rgb::rec709))};
    }
    if (params.velocity) {
        const Interval& shutter = scene.built.shutter;
        extras.velocity = GridVelocity{std::move(*grids[next++].vector), keyOf(params.velocity, "scale", 1),
                                       shutter.open - params.time.value_or(shutter.open), shutter.duration};
        if (shutter.duration > 0) scene.noteEffect(Effect::motion, params.velocity->span, "the volume drifts");
    }
    extras.glow = makeGlow(params, optics, params.temperature.has_value());
    return extras;
}

bool checkVdbGlow(const VdbParams& params, const MediumOptics& optics, const MediumContext& context) {
    const auto say = [&](std::string_view fault) {
        context.scene.diagnostics.error("E0647", context.definition.span, "this volume cannot emit like this",
                                        std::string(fault));
        return false;
    };
    const auto fault = findContradiction(params, optics, params.temperature.has_value(), params.color.has_value());
    if (!fault.empty()) return say(fault);
    if (params.flame && !params.temperature && !params.emission)
        return say("`flame` goes with `temperature` or `emission`");
    return true;
}

bool checkDrift(const VdbParams& params, const VoxelGrid& density, const GridExtras& extras, const Transform& place,
                Diagnostics& diagnostics) {
    if (!extras.velocity) return true;
    double drift = driftInVoxels(*extras.velocity, density, place);
    for (const auto& other : {&extras.flame, &extras.temperature})
        if (*other) drift = std::max(drift, driftInVoxels(*extras.velocity, (*other)->grid, place));
    if (drift <= kFurthestDrift) return true;
    diagnostics
        .error("E0646", params.velocity->span,
               fmt::format("this volume drifts by up to {:.0f} voxels while the shutter is open", drift),
               fmt::format("the most is {:.0f}", kFurthestDrift))
        .help = "see `scale=` of the velocity, `time` and the camera's shutter; `abbe volume info FILE` tells how fast "
                "it is";
    return false;
}

MadeMedium volumeOf(const VdbParams& params, const MediumOptics& optics, VoxelGrid density, GridExtras extras,
                    const Transform& place, BuildContext& scene, const Digest& grids) {
    Diagnostics& diagnostics = scene.diagnostics;
    if (!checkDrift(params, density, extras, place, diagnostics)) return {};
    const bool hot = extras.glow && extras.glow->thermal();
    const double hottest = hot ? extras.temperature->offset +
                                     extras.temperature->scale * static_cast<double>(extras.temperature->grid.maximum())
                               : 0;
    if (!(hottest < kHottest)) {
        diagnostics.error("E0647", params.temperature->span,
                          fmt::format("the hottest of this volume is {:.4g} K", hottest), "nothing is as hot");
        return {};
    }
    auto medium = std::make_unique<GridMedium>(optics, std::move(density), keyOf(params.density, "scale", 1), place,
                                               std::move(extras), scene.tables(), grids);
    std::unique_ptr<Light> light;
    if (medium->gridEmission())
        light = std::make_unique<VolumeLight>(*medium->gridEmission());
    else if (hot)
        diagnostics
            .warning("W0693", params.temperature->span,
                     fmt::format("nothing of this volume glows: the hottest of it is {:.4g} K", hottest))
            .help = "`scale=` and `offset=` turn the numbers of the file into kelvin; flames are at 1200 to 2200 K";
    return {std::move(medium), std::move(light)};
}

} // namespace

MadeMedium makeVdbVolume(const VdbParams& params, const MediumContext& context) {
    Diagnostics& diagnostics = context.scene.diagnostics;
    const auto optics = context.media.opticsOf(params, context.definition);
    const Transform place = params.transform.then(context.toRender);
    if (!place.inverse())
        diagnostics.error("E0641", context.definition.span, "the transform of this volume flattens it",
                          "has no inverse");
    if (!optics || !place.inverse() || !checkVdbGlow(params, *optics, context)) return {};
    const GridRequests requests(params);
    const Digest key = requests.digest(params.file.value);
    const auto read =
        context.scene.reused<std::vector<VdbGrid>>(Reused::volume, key, std::span(&params.file.span, 1),
                                                   [&] { return readGrids(params.file, requests, diagnostics); });
    if (!read) return {};
    context.scene.noteFile(params.file.value);
    std::vector<VdbGrid> grids = *read; // of the same voxels
    if (grids[0].scalar->empty())
        diagnostics.warning("W0691", params.file.span, "this grid has no voxels", "nothing will be seen of it");
    GridExtras extras = extrasOf(params, *optics, std::span(grids).subspan(1), context.scene);
    return volumeOf(params, *optics, std::move(*grids[0].scalar), std::move(extras), place, context.scene, key);
}

} // namespace abbe
