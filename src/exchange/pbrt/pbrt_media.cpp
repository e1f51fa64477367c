#include "exchange/pbrt/pbrt_media.h"

#include "exchange/shared/vdb_writer.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace abbe::exchange {

namespace {

struct PbrtPreset {
    std::string_view name;
    Vec3d scattering, absorption; // reduced scattering, per mm
};
// [Jensen2001, fig. 5], which pbrt's named media of these names are.
constexpr std::array<PbrtPreset, 12> kPbrtPresets{{{"Apple", {2.29, 2.39, 1.97}, {0.0030, 0.0034, 0.046}},
                                                   {"Chicken1", {0.15, 0.21, 0.38}, {0.015, 0.077, 0.19}},
                                                   {"Chicken2", {0.19, 0.25, 0.32}, {0.018, 0.088, 0.20}},
                                                   {"Cream", {7.38, 5.47, 3.15}, {0.0002, 0.0028, 0.0163}},
                                                   {"Ketchup", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}},
                                                   {"Marble", {2.19, 2.62, 3.00}, {0.0021, 0.0041, 0.0071}},
                                                   {"Potato", {0.68, 0.70, 0.55}, {0.0024, 0.0090, 0.12}},
                                                   {"Skimmilk", {0.70, 1.22, 1.90}, {0.0014, 0.0025, 0.0142}},
                                                   {"Skin1", {0.74, 0.88, 1.01}, {0.032, 0.17, 0.48}},
                                                   {"Skin2", {1.09, 1.59, 1.79}, {0.013, 0.070, 0.145}},
                                                   {"Spectralon", {11.6, 20.4, 14.9}, {0, 0, 0}},
                                                   {"Wholemilk", {2.55, 3.21, 3.77}, {0.0011, 0.0024, 0.014}}}};

const PbrtPreset& pbrtPreset(const PbrtParams& params, std::string_view param, SceneNode& node, PbrtShared& shared) {
    const PbrtPreset& milk = kPbrtPresets.back(); // pbrt's default
    const std::string name = params.text(param, "", shared.faults());
    if (name.empty()) return milk;
    for (const PbrtPreset& preset : kPbrtPresets)
        if (preset.name == name) return preset;
    shared.out.approximated(&node, params.spanOf(param), fmt::format("the medium `{}`", name),
                            "its figures are not known here; it is whole milk");
    return milk;
}

// Every 5 nm of what a metre of a medium emits: pbrt's Le is per absorption [Pharr2023, sec. 11.4.2].
void pbrtEmission(SceneNode& node, const PbrtSpectrum& absorption, const PbrtLight& light, double scale) {
    const auto sigma = absorption.curve(PbrtUse::unbounded), emitted = light.spectrum.curve(PbrtUse::light);
    const bool isColour = light.spectrum.kind == PbrtSpectrum::Kind::rgb;
    const double own = isColour ? 1 : light.spectrum.luminance();
    std::vector<double> pairs;
    for (double nm = 360; nm <= 830; nm += 5) pairs.insert(pairs.end(), {nm, sigma->at(nm) * emitted->at(nm)});
    pbrtWriteTable(node, pairs, scale * light.scale / (own > 0 ? own : 1));
}

constexpr std::array<std::pair<const char*, const char*>, 2> kPbrtCoefficients{
    {{"sigma_s", "scattering"}, {"sigma_a", "absorption"}}};

} // namespace

void pbrtCoefficients(SceneNode& medium, const PbrtParams& params, std::string_view presetParam, double scale,
                      PbrtShared& shared) {
    const PbrtPreset& preset = pbrtPreset(params, presetParam, medium, shared);
    const auto write = [&](std::string_view param, const char* property, Vec3d absent) {
        const PbrtParam* given = params.find(param);
        const auto spectrum = given ? pbrtSpectrum(*given, PbrtUse::unbounded, shared) : std::nullopt;
        (spectrum ? *spectrum : PbrtSpectrum::colour(absent)).write(medium.child(property), PbrtUse::unbounded, scale);
    };
    write("sigma_s", "scattering", preset.scattering);
    write("sigma_a", "absorption", preset.absorption);
}

void PbrtMedia::coefficient(SceneNode& node, const PbrtParams& params, const char* param, const char* property,
                            double scale) {
    const PbrtParam* given = params.find(param);
    const auto spectrum = given ? pbrtSpectrum(*given, PbrtUse::unbounded, shared_) : std::nullopt;
    (spectrum ? *spectrum : PbrtSpectrum::flat(1)).write(node.child(property), PbrtUse::unbounded, scale);
}

void PbrtMedia::phase(SceneNode& medium, const PbrtParams& params) {
    const double g = params.number("g", 0, shared_.faults());
    if (g != 0) medium.child("phase").word("henyey-greenstein").number(std::clamp(g, -0.9999, 0.9999));
}

void PbrtMedia::homogeneous(SceneNode& medium, const PbrtParams& params) {
    const double scale = params.number("scale", 1, shared_.faults());
    pbrtCoefficients(medium, params, "preset", scale, shared_);
    phase(medium, params);
    const PbrtParam* emitted = params.find("Le");
    const double emissionScale = params.number("Lescale", 1, shared_.faults());
    if (!emitted || emissionScale == 0) return;
    PbrtLight light = pbrtLight(params, "Le", emitted->colorSpace, shared_);
    light.scale = emissionScale;
    const PbrtParam* given = params.find("sigma_a");
    const auto absorption = given ? pbrtSpectrum(*given, PbrtUse::unbounded, shared_) : std::nullopt;
    if (!light.spectrum.isBlack())
        pbrtEmission(medium.child("emission"),
                     absorption ? *absorption : PbrtSpectrum::colour(kPbrtPresets.back().absorption), light, scale);
}

// The number of voxels along each axis, if there are as many values as they need.
std::optional<std::array<int, 3>> PbrtMedia::counts(const PbrtParams& params, std::string_view grid,
                                                    std::size_t channels) {
    Diagnostics& faults = shared_.faults();
    std::array<int, 3> counts{};
    double product = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        constexpr std::array<const char*, 3> kNames = {"nx", "ny", "nz"};
        counts[i] = params.integer(kNames[i], 1, faults);
        product *= std::max(counts[i], 0);
    }
    const auto given = static_cast<double>(params.numbers(grid).size()) / static_cast<double>(channels);
    if (product > 0 && given == product) return counts;
    faults.error(
        "E0802", params.spanOf(grid),
        fmt::format("`{}` has {} values for {} × {} × {} voxels", grid, given, counts[0], counts[1], counts[2]));
    return std::nullopt;
}

// pbrt's voxels have their middles at (i + 1/2) / n of the box from p0 to p1, those of our files at i.
void PbrtMedia::grid(PbrtMedium& made, const PbrtParams& params, const Transform& place, const std::string& stem,
                     std::array<int, 3> counts, std::span<const float> density) {
    Diagnostics& faults = shared_.faults();
    const Vec3d p0 = params.point("p0", {0, 0, 0}, faults), p1 = params.point("p1", {1, 1, 1}, faults);
    const Vec3d step{(p1.x - p0.x) / counts[0], (p1.y - p0.y) / counts[1], (p1.z - p0.z) / counts[2]};
    if (step.x == 0 || step.y == 0 || step.z == 0)
        return void(faults.error("E0802", params.directive, "the box of this grid is empty"));
    made.node.word("vdb").text(shared_.out.files.write(stem, "vdb", vdbFile(counts, density)));
    writeTransform(made.node, Transform::scale(step).then(Transform::translate(p0 + step * 0.5)).then(place));
    phase(made.node, params);
    for (const char* emission : {"Le", "Lescale", "temperature", "temperatureoffset", "temperaturescale",
                                 "temperaturecutoff", "emissivescale"})
        if (params.has(emission) && std::string_view(emission) != "Lescale")
            shared_.out.leftOut(&made.node, params.spanOf(emission), fmt::format("`{}` of a grid", emission),
                                "what a grid emits is not carried over");
}

void PbrtMedia::uniformGrid(PbrtMedium& made, const PbrtParams& params, const Transform& place,
                            const std::string& name) {
    const double scale = params.number("scale", 1, shared_.faults());
    const auto size = counts(params, "density", 1);
    if (!size) return;
    const auto values = params.numbers("density");
    grid(made, params, place, name, *size, std::vector<float>(values.begin(), values.end()));
    for (const auto& [param, property] : kPbrtCoefficients) coefficient(made.node, params, param, property, scale);
}

// Colours at voxels: their mean over the channels is the density, and the colour of all of it that of the whole.
void PbrtMedia::rgbGrid(PbrtMedium& made, const PbrtParams& params, const Transform& place, const std::string& name) {
    const double scale = params.number("scale", 1, shared_.faults());
    const auto size = counts(params, params.has("sigma_s") ? "sigma_s" : "sigma_a", 3);
    if (!size) return;
    const auto voxels = static_cast<std::size_t>((*size)[0]) * static_cast<std::size_t>((*size)[1]) *
                        static_cast<std::size_t>((*size)[2]);
    std::vector<float> density(voxels);
    std::array<Vec3d, 2> sums;
    for (std::size_t k = 0; k < 2; ++k) {
        const auto values = params.numbers(kPbrtCoefficients[k].first);
        for (std::size_t i = 0; i < voxels; ++i) {
            const bool isGiven = values.size() == 3 * voxels; // 1 when absent
            const Vec3d c = isGiven ? Vec3d{values[3 * i], values[3 * i + 1], values[3 * i + 2]} : Vec3d{1, 1, 1};
            sums[k] += c;
            density[i] += static_cast<float>((c.x + c.y + c.z) / 3);
        }
    }
    const double all = (dot(sums[0], Vec3d(1, 1, 1)) + dot(sums[1], Vec3d(1, 1, 1))) / 3;
    grid(made, params, place, name, *size, density);
    for (std::size_t k = 0; k < 2; ++k)
        PbrtSpectrum::colour(max(all > 0 ? sums[k] / all : Vec3d(), Vec3d()))
            .write(made.node.child(kPbrtCoefficients[k].second), PbrtUse::unbounded, scale);
    shared_.out.approximated(&made.node, params.directive, "a grid of colours",
                             "its density varies from place to place, its colour is the mean everywhere");
}

void PbrtMedia::nanovdb(PbrtMedium& made, const PbrtParams& params, const Transform& place) {
    Diagnostics& faults = shared_.faults();
    for (const char* known : {"Lescale", "temperaturecutoff", "temperatureoffset", "temperaturescale"})
        params.find(known);
    std::filesystem::path file = shared_.file(params.text("filename", "", faults));
    std::error_code error;
    if (!std::filesystem::exists(file, error)) { // some scenes are handed on with what their grids were made from
        std::filesystem::path source = file;
        source.replace_extension(".vdb");
        if (std::filesystem::exists(source, error)) file = source;
    }
    made.node.word("vdb").text(shared_.out.files.refer(file));
    const double scale = params.number("scale", 1, faults);
    for (const auto& [param, property] : kPbrtCoefficients) coefficient(made.node, params, param, property, scale);
    phase(made.node, params);
    if (params.has("Lescale"))
        shared_.out.leftOut(&made.node, params.spanOf("Lescale"), "what a volume emits by its temperature",
                            "write `temperature` and `emissivity` of the volume by hand");
    writeTransform(made.node, place);
}

void PbrtMedia::cloud(PbrtMedium& made, const PbrtParams& params, const Transform& place) {
    Diagnostics& faults = shared_.faults();
    const Vec3d p0 = params.point("p0", {0, 0, 0}, faults), p1 = params.point("p1", {1, 1, 1}, faults);
    const double density = params.number("density", 1, faults), wisps = params.number("wispiness", 1, faults);
    const double frequency = params.number("frequency", 5, faults);
    SceneNode& node = made.node.word("noise");
    node.child("min").vector(min(p0, p1));
    node.child("max").vector(max(p0, p1));
    node.child("pattern").word("billow");
    node.child("scale").number(std::clamp(1 / (frequency > 0 ? frequency : 1), 1e-6, 1e9)).word("m");
    node.child("warp").number(std::clamp(wisps * 0.3, 0.0, 10.0));
    for (const auto& [param, property] : kPbrtCoefficients)
        coefficient(node, params, param, property, std::max(density, 0.0));
    phase(node, params);
    writeTransform(node, place);
    shared_.out.approximated(&node, params.directive, "a medium of type `cloud`",
                             "`volume noise` has other heaps of about that size in the same box");
}

void PbrtMedia::define(const std::string& name, const PbrtParams& params, const Transform& place) {
    const std::string type = params.text("type", "", shared_.faults());
    if (media_.contains(name))
        shared_.faults().error("E0802", params.directive, fmt::format("the medium `{}` is defined twice", name));
    PbrtMedium made;
    if (type == "nanovdb") {
        nanovdb(made, params, place);
    } else if (type == "cloud") {
        cloud(made, params, place);
    } else if (type == "uniformgrid") {
        uniformGrid(made, params, place, name);
    } else if (type == "rgbgrid") {
        rgbGrid(made, params, place, name);
    } else if (type == "homogeneous") {
        made.word = shared_.mediumNames.take(name, "medium");
        SceneNode medium("medium");
        medium.name(made.word).word("homogeneous");
        homogeneous(medium, params);
        shared_.definitions.push_back(std::move(medium));
    } else {
        shared_.faults().error("E0802", params.spanOf("type"), fmt::format("there is no type of medium `{}`", type));
        return;
    }
    params.reportUnused(fmt::format("the medium `{}`", type), shared_.faults());
    media_.insert_or_assign(name, std::move(made));
}

const PbrtMedium* PbrtMedia::use(const std::string& name, Span span) {
    const auto found = media_.find(name);
    if (found == media_.end()) {
        auto& d = shared_.faults().error("E0802", span, fmt::format("there is no medium `{}`", name));
        for (const auto& [known, medium] : media_)
            if (schema::editDistance(known, name) <= 1 + name.size() / 4) d.help = schema::didYouMean(known);
        return nullptr;
    }
    PbrtMedium& medium = found->second;
    if (medium.word.empty() && !medium.isPlaced) {
        shared_.world.push_back(medium.node);
        medium.isPlaced = true;
    }
    return &medium;
}

} // namespace abbe::exchange
