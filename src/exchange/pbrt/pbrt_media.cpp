#include "exchange/pbrt/pbrt_media.h"

#include "base/file.h"
#include "exchange/shared/inflate.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
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
                     std::array<int, 3> counts, std::span<const VdbGrid> grids) {
    Diagnostics& faults = shared_.faults();
    const Vec3d p0 = params.point("p0", {0, 0, 0}, faults), p1 = params.point("p1", {1, 1, 1}, faults);
    const Vec3d step{(p1.x - p0.x) / counts[0], (p1.y - p0.y) / counts[1], (p1.z - p0.z) / counts[2]};
    if (step.x == 0 || step.y == 0 || step.z == 0)
        return void(faults.error("E0802", params.directive, "the box of this grid is empty"));
    made.node.word("vdb").text(shared_.out.files.write(stem, "vdb", vdbFile(counts, grids)));
    writeTransform(made.node, Transform::scale(step).then(Transform::translate(p0 + step * 0.5)).then(place));
    phase(made.node, params);
}

namespace {

// The most that a black body emits at any wavelength, in W per m², sr and nm.
double planckPeak(double kelvin) { return 4.0956759e-15 * std::pow(kelvin, 5); }

// Of a place with that number in a grid; nothing is emitted by what is colder than pbrt's least.
double pbrtKelvin(const PbrtParams& params, double value, Diagnostics& faults) {
    const double offset = params.number("temperatureoffset", params.number("temperaturecutoff", 0, faults), faults);
    const double kelvin = (value - offset) * params.number("temperaturescale", 1, faults);
    return kelvin > 100 && kelvin < 1e6 ? kelvin : 0;
}

} // namespace

std::vector<float> PbrtMedia::temperatures(const PbrtParams& params, std::size_t voxels) {
    const auto values = params.numbers("temperature");
    std::vector<float> kelvin;
    if (values.size() != voxels) return kelvin;
    for (const double value : values) kelvin.push_back(static_cast<float>(pbrtKelvin(params, value, shared_.faults())));
    return kelvin;
}

// pbrt's black bodies are all equally bright, at the wavelength where they emit most: the amount of what emits takes
// that in.
std::vector<float> PbrtMedia::flames(SceneNode& node, const PbrtParams& params, std::span<const float> density,
                                     std::span<const float> kelvin) {
    const auto factors = params.numbers("Lescale");
    std::vector<float> amounts;
    for (std::size_t i = 0; i < density.size(); ++i) {
        const double factor = factors.size() == density.size() ? factors[i] : factors.empty() ? 1 : factors[0];
        const double peak = kelvin.empty() ? 1 : kelvin[i] > 0 ? planckPeak(static_cast<double>(kelvin[i])) : 0;
        amounts.push_back(peak > 0 ? static_cast<float>(std::max(density[i] * factor / peak, 0.0)) : 0);
    }
    if (!kelvin.empty())
        shared_.out.approximated(&node, params.spanOf("temperature"), "what a grid emits by its temperature",
                                 "it is pbrt's in the middles of voxels; between them temperature and amount vary, and "
                                 "not the light");
    return amounts;
}

void PbrtMedia::uniformGrid(PbrtMedium& made, const PbrtParams& params, const Transform& place,
                            const std::string& name) {
    const double scale = params.number("scale", 1, shared_.faults());
    const auto size = counts(params, "density", 1);
    if (!size) return;
    const auto values = params.numbers("density");
    const std::vector<float> density(values.begin(), values.end());
    const std::vector<float> kelvin = temperatures(params, density.size());
    const bool shines = !kelvin.empty() || params.has("Le");
    std::vector<float> flame;
    if (shines) flame = flames(made.node, params, density, kelvin);
    std::vector<VdbGrid> grids{{"density", density}};
    if (!kelvin.empty()) grids.push_back({"temperature", kelvin});
    if (shines) grids.push_back({"flame", flame});
    if (params.has("temperature") && kelvin.empty())
        shared_.faults().error("E0802", params.spanOf("temperature"),
                               fmt::format("`temperature` has not the {} values of `density`", density.size()));
    grid(made, params, place, name, *size, grids);
    for (const auto& [param, property] : kPbrtCoefficients) coefficient(made.node, params, param, property, scale);
    if (shines) made.node.child("flame").word("flame");
    if (!kelvin.empty()) {
        made.node.child("temperature").word("temperature");
        coefficient(made.node, params, "sigma_a", "emissivity", scale);
    } else if (shines) {
        const PbrtParam* const absorption = params.find("sigma_a");
        const auto sigma = absorption ? pbrtSpectrum(*absorption, PbrtUse::unbounded, shared_) : std::nullopt;
        const PbrtLight light = pbrtLight(params, "Le", params.find("Le")->colorSpace, shared_);
        if (!light.spectrum.isBlack())
            pbrtEmission(made.node.child("emission"), sigma ? *sigma : PbrtSpectrum::flat(1), light, scale);
    }
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
    const VdbGrid whole{"density", density};
    grid(made, params, place, name, *size, std::span(&whole, 1));
    for (const char* emission : {"Le", "Lescale"})
        if (params.has(emission))
            shared_.out.leftOut(&made.node, params.spanOf(emission), fmt::format("`{}` of a grid of colours", emission),
                                "what it emits is not carried over");
    for (std::size_t k = 0; k < 2; ++k)
        PbrtSpectrum::colour(max(all > 0 ? sums[k] / all : Vec3d(), Vec3d()))
            .write(made.node.child(kPbrtCoefficients[k].second), PbrtUse::unbounded, scale);
    shared_.out.approximated(&made.node, params.directive, "a grid of colours",
                             "its density varies from place to place, its colour is the mean everywhere");
}

namespace {

// The largest number of a grid in a NanoVDB file of layout 32, if it can be had: the file is damaged, packed by Blosc
// or has no such grid otherwise.
std::optional<double> nanovdbMaximum(const std::filesystem::path& path, std::string_view wanted) {
    RegularFile file(path.string());
    const auto read = [&](std::uint64_t offset, auto& value) {
        std::array<char, sizeof value> bytes;
        if (file.readAt(offset, bytes) != bytes.size()) return false;
        std::memcpy(&value, bytes.data(), sizeof value);
        return true;
    };
    constexpr std::uint64_t kHeader = 16, kEntry = 176, kMaximum = 736 + 36; // behind grid and tree, of the root
    constexpr std::size_t kLongestName = 256;
    for (std::uint64_t at = 0; at + kHeader < file.size();) {
        std::uint64_t magic = 0;
        std::uint16_t grids = 0;
        if (!read(at, magic) || magic != 0x304244566f6e614eull || !read(at + 12, grids)) return std::nullopt;
        std::uint64_t entry = at + kHeader, data = entry;
        for (int i = 0; i < grids; ++i) { // names stand between the entries, grids behind all of them
            std::uint32_t length = 0;
            if (!read(data + 136, length) || length > kLongestName) return std::nullopt;
            data += kEntry + length;
        }
        for (int i = 0; i < grids; ++i) {
            std::uint64_t packed = 0;
            std::uint32_t length = 0;
            std::uint16_t codec = 0;
            if (!read(entry + 8, packed) || !read(entry + 136, length) || !read(entry + 168, codec))
                return std::nullopt;
            std::string name(length, '\0');
            if (file.readAt(entry + kEntry, name) == length && std::string_view(name.c_str()) == wanted) {
                std::string head(kMaximum + 4, '\0');
                if (codec == 1) {
                    std::string part(std::min<std::uint64_t>(packed, 65536), '\0');
                    part.resize(file.readAt(data + 8, part));
                    head = inflated(part, Packing::zlib, head.size()).bytes;
                } else if (codec != 0 || file.readAt(data, head) != head.size()) {
                    return std::nullopt;
                }
                if (head.size() < kMaximum + 4) return std::nullopt;
                float maximum = 0;
                std::memcpy(&maximum, head.data() + kMaximum, sizeof maximum);
                return std::isfinite(maximum) ? std::optional(static_cast<double>(maximum)) : std::nullopt;
            }
            entry += kEntry + length;
            data += packed;
        }
        at = data;
    }
    return std::nullopt;
}

} // namespace

void PbrtMedia::nanovdbEmission(SceneNode& node, const PbrtParams& params, const std::filesystem::path& file) {
    Diagnostics& faults = shared_.faults();
    for (const char* known : {"temperaturecutoff", "temperatureoffset", "temperaturescale"}) params.find(known);
    const double factor = params.number("Lescale", 1, faults);
    const auto most = nanovdbMaximum(file, "temperature");
    const double kelvin = most ? pbrtKelvin(params, *most, faults) : 0;
    if (kelvin > 0 && factor > 0) {
        SceneNode& grid = node.child("temperature").word("temperature");
        const double scale = params.number("temperaturescale", 1, faults);
        grid.key("scale", scale).key("offset", pbrtKelvin(params, *most, faults) - *most * scale);
        coefficient(node, params, "sigma_a", "emissivity",
                    params.number("scale", 1, faults) * factor / planckPeak(kelvin));
        shared_.out.approximated(&node, params.directive, "what a volume emits by its temperature",
                                 fmt::format("it is as bright as pbrt's where it is hottest, at {:.4g} K, and darker "
                                             "where it is colder, as black bodies are",
                                             kelvin));
    } else if (params.has("Lescale") && factor > 0) {
        shared_.out.leftOut(&node, params.spanOf("Lescale"), "what a volume emits by its temperature",
                            "how hot it gets cannot be read from its file: write `temperature` and `emissivity` of the "
                            "volume by hand");
    }
}

void PbrtMedia::nanovdb(PbrtMedium& made, const PbrtParams& params, const Transform& place) {
    Diagnostics& faults = shared_.faults();
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
    nanovdbEmission(made.node, params, file);
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
