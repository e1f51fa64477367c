#include "exchange/pbrt/pbrt_media.h"

#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

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

// The mean of the values of a grid, 0 of an empty one.
double pbrtMean(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
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

// Grids of numbers in the text itself: only files of OpenVDB hold grids here.
void PbrtMedia::meanOfGrid(SceneNode& medium, const PbrtParams& params, const std::string& type) {
    Diagnostics& faults = shared_.faults();
    const double scale = params.number("scale", 1, faults);
    for (const char* known : {"nx", "ny", "nz", "p0", "p1", "Lescale", "temperature", "temperatureoffset",
                              "temperaturescale", "temperaturecutoff"})
        params.find(known);
    for (const char* emission : {"Le", "temperature"})
        if (params.has(emission))
            shared_.out.leftOut(&medium, params.spanOf(emission), fmt::format("`{}` of a grid", emission),
                                "what a grid emits is not carried over");
    if (type == "uniformgrid") {
        const double mean = pbrtMean(params.numbers("density"));
        for (const auto& [param, property] : {std::pair("sigma_s", "scattering"), std::pair("sigma_a", "absorption")}) {
            const PbrtParam* given = params.find(param);
            const auto spectrum = given ? pbrtSpectrum(*given, PbrtUse::unbounded, shared_) : std::nullopt;
            (spectrum ? *spectrum : PbrtSpectrum::flat(1))
                .write(medium.child(property), PbrtUse::unbounded, scale * mean);
        }
    } else {
        for (const auto& [param, property] : {std::pair("sigma_s", "scattering"), std::pair("sigma_a", "absorption")}) {
            Vec3d sum;
            const auto values = params.numbers(param);
            for (std::size_t i = 0; i + 2 < values.size(); i += 3) sum += {values[i], values[i + 1], values[i + 2]};
            if (values.size() >= 3) sum = sum * (3 / static_cast<double>(values.size()));
            PbrtSpectrum::colour(values.empty() ? Vec3d(1, 1, 1) : sum)
                .write(medium.child(property), PbrtUse::unbounded, scale);
        }
    }
    phase(medium, params);
    shared_.out.approximated(&medium, params.directive, fmt::format("the grid of a medium of type `{}`", type),
                             "grids are read from OpenVDB files only; it has its mean everywhere");
}

bool PbrtMedia::nanovdb(PbrtMedium& made, const PbrtParams& params, const Transform& place) {
    Diagnostics& faults = shared_.faults();
    const std::string name = params.text("filename", "", faults);
    for (const char* known :
         {"Lescale", "temperaturename", "temperaturecutoff", "temperatureoffset", "temperaturescale", "densityname"})
        params.find(known);
    std::filesystem::path file = shared_.file(name);
    file.replace_extension(".vdb");
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        shared_.out.leftOut(
            nullptr, params.directive, fmt::format("the volume `{}`", name),
            fmt::format("NanoVDB files are not read; `{}` beside it would be", file.filename().string()));
        for (const char* known : {"sigma_s", "sigma_a", "scale", "g"}) params.find(known);
        return false;
    }
    made.node.word("vdb").text(shared_.out.files.refer(file));
    const double scale = params.number("scale", 1, faults);
    for (const auto& [param, property] : {std::pair("sigma_s", "scattering"), std::pair("sigma_a", "absorption")}) {
        const PbrtParam* given = params.find(param);
        const auto spectrum = given ? pbrtSpectrum(*given, PbrtUse::unbounded, shared_) : std::nullopt;
        (spectrum ? *spectrum : PbrtSpectrum::flat(1)).write(made.node.child(property), PbrtUse::unbounded, scale);
    }
    phase(made.node, params);
    if (params.has("Lescale"))
        shared_.out.leftOut(&made.node, params.spanOf("Lescale"), "what a volume emits by its temperature",
                            "write `temperature` and `emissivity` of the volume by hand");
    pbrtTransform(made.node, place);
    return true;
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
    for (const auto& [param, property] : {std::pair("sigma_s", "scattering"), std::pair("sigma_a", "absorption")}) {
        const PbrtParam* given = params.find(param);
        const auto spectrum = given ? pbrtSpectrum(*given, PbrtUse::unbounded, shared_) : std::nullopt;
        (spectrum ? *spectrum : PbrtSpectrum::flat(1))
            .write(node.child(property), PbrtUse::unbounded, std::max(density, 0.0));
    }
    phase(node, params);
    pbrtTransform(node, place);
    shared_.out.approximated(&node, params.directive, "a medium of type `cloud`",
                             "`volume noise` has other heaps of about that size in the same box");
}

void PbrtMedia::define(const std::string& name, const PbrtParams& params, const Transform& place) {
    const std::string type = params.text("type", "", shared_.faults());
    if (media_.contains(name))
        shared_.faults().error("E0802", params.directive, fmt::format("the medium `{}` is defined twice", name));
    PbrtMedium made;
    if (type == "nanovdb") {
        if (!nanovdb(made, params, place)) made.isPlaced = true; // there is nothing to place
    } else if (type == "cloud") {
        cloud(made, params, place);
    } else if (type == "homogeneous" || type == "uniformgrid" || type == "rgbgrid") {
        made.word = shared_.mediumNames.take(name, "medium");
        SceneNode medium("medium");
        medium.name(made.word).word("homogeneous");
        if (type == "homogeneous")
            homogeneous(medium, params);
        else
            meanOfGrid(medium, params, type);
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
