#include "exchange/pbrt/pbrt_spectrum.h"

#include "io/file.h"
#include "schema/suggest.h"
#include "spectrum/color_space.h"
#include "spectrum/emission_curves.h"
#include "spectrum/named_spectra.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <sstream>

namespace abbe::exchange {

namespace {

constexpr double kPbrtFirstNm = 360, kPbrtLastNm = 830;

struct PbrtGlassName {
    std::string_view pbrt, ours;
};
// pbrt calls three of Schott's glasses by their numbers alone.
constexpr std::array<PbrtGlassName, 10> kPbrtGlasses{{{"BK7", "BK7"},
                                                      {"BAF10", "BAF10"},
                                                      {"FK51A", "FK51A"},
                                                      {"LASF9", "N-LASF9"},
                                                      {"F5", "N-SF5"},
                                                      {"SF5", "N-SF5"},
                                                      {"F10", "SF10"},
                                                      {"SF10", "SF10"},
                                                      {"F11", "SF11"},
                                                      {"SF11", "SF11"}}};

const RgbSpace pbrtSpace(const std::string& word) { return findRgbSpace(word).value_or(rgb::rec709); }

// As many digits as pbrt's own numbers have.
double pbrtRounded(double value) { return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr); }

// Every 5 nm of a curve, as a table's pairs.
std::vector<double> pbrtSampled(const Curve& curve) {
    std::vector<double> pairs;
    for (double nm = kPbrtFirstNm; nm <= kPbrtLastNm; nm += 5) {
        pairs.push_back(nm);
        pairs.push_back(curve.at(nm));
    }
    return pairs;
}

// pbrt's tables are 0 beyond their ends, ours of reflectances go on as they end.
void pbrtEndInZero(std::vector<double>& pairs) {
    constexpr double kStep = 0.001;
    if (pairs.front() > kPbrtFirstNm && pairs[1] != 0) pairs.insert(pairs.begin(), {pairs.front() - kStep, 0.0});
    if (pairs[pairs.size() - 2] < kPbrtLastNm && pairs.back() != 0) {
        const double end = pairs[pairs.size() - 2] + kStep;
        pairs.insert(pairs.end(), {end, 0.0});
    }
}

// Why the pairs are no table of a use, or null.
const char* pbrtTableFault(const std::vector<double>& pairs, PbrtUse use) {
    if (pairs.size() % 2 != 0 || pairs.empty()) return "takes pairs of wavelength and value";
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
        if (pairs[i] <= 0) return "has a wavelength that is not above 0";
        if (i > 0 && pairs[i] <= pairs[i - 2]) return "has wavelengths that do not increase";
        if (use == PbrtUse::index ? pairs[i + 1] < 0 : pairs[i + 1] < 0) return "has a negative value";
    }
    return nullptr;
}

std::optional<std::vector<double>> pbrtSpectrumFile(const std::filesystem::path& path, std::string& fault) {
    std::string text;
    try {
        text = pbrtReadFile(path);
    } catch (const IoError& error) {
        fault = error.what();
        return std::nullopt;
    }
    std::vector<double> values;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        line = line.substr(0, line.find('#'));
        std::istringstream words(line);
        for (double value = 0; words >> value;) values.push_back(value);
        if (values.size() > 200'000) break; // no spectrum; wavelengths would have increased out of all bounds
    }
    return values;
}

std::unique_ptr<Curve> pbrtTableCurve(const std::vector<double>& pairs, PbrtUse use) {
    std::vector<double> nm, values;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
        nm.push_back(pairs[i]);
        values.push_back(pairs[i + 1]);
    }
    return std::make_unique<SampledCurve>(use == PbrtUse::light ? SampledCurve::fromEmissionPoints(nm, values)
                                                                : SampledCurve::fromPoints(nm, values));
}

std::optional<PbrtSpectrum> pbrtTable(const PbrtParam& param, std::vector<double> pairs, PbrtUse use,
                                      PbrtShared& shared) {
    if (const char* fault = pbrtTableFault(pairs, use)) {
        shared.faults().error("E0802", param.span, fmt::format("the spectrum `{}` {}", param.name, fault));
        return std::nullopt;
    }
    if (use == PbrtUse::index && pairs.size() == 2) return PbrtSpectrum::flat(pairs[1]);
    PbrtSpectrum spectrum;
    spectrum.kind = PbrtSpectrum::Kind::table;
    if (use == PbrtUse::albedo || use == PbrtUse::unbounded) pbrtEndInZero(pairs);
    if (use == PbrtUse::albedo)
        for (std::size_t i = 1; i < pairs.size(); i += 2)
            if (pairs[i] > 1) {
                shared.out.approximated(nullptr, param.span, fmt::format("a value above 1 of `{}`", param.name),
                                        "a reflectance is at most 1");
                for (std::size_t j = 1; j < pairs.size(); j += 2) pairs[j] = std::min(pairs[j], 1.0);
                break;
            }
    spectrum.pairs = std::move(pairs);
    return spectrum;
}

std::optional<PbrtSpectrum> pbrtColour(const PbrtParam& param, PbrtUse use, PbrtShared& shared) {
    if (param.numbers.size() != 3) {
        shared.faults().error("E0802", param.span, fmt::format("the colour `{}` takes three numbers", param.name));
        return std::nullopt;
    }
    PbrtSpectrum spectrum = PbrtSpectrum::colour({param.numbers[0], param.numbers[1], param.numbers[2]});
    if (minComponent(spectrum.rgb) < 0) {
        shared.faults().error("E0802", param.span, fmt::format("the colour `{}` has a negative part", param.name));
        return std::nullopt;
    }
    if (use == PbrtUse::albedo && maxComponent(spectrum.rgb) > 1) {
        shared.out.approximated(nullptr, param.span, fmt::format("a part above 1 of the colour `{}`", param.name),
                                "a reflectance is at most 1");
        spectrum.rgb = min(spectrum.rgb, Vec3d(1, 1, 1));
    }
    spectrum.space = pbrtSpaceWord(param.colorSpace);
    return spectrum;
}

std::optional<PbrtSpectrum> pbrtByName(const PbrtParam& param, PbrtUse use, PbrtShared& shared) {
    if (auto named = pbrtNamedSpectrum(param.texts[0])) return named;
    std::string fault;
    if (auto pairs = pbrtSpectrumFile(shared.file(param.texts[0]), fault))
        return pbrtTable(param, std::move(*pairs), use, shared);
    shared.faults().error("E0802", param.span,
                          fmt::format("there is no spectrum `{}`, and no such file", param.texts[0]), fault);
    return std::nullopt;
}

} // namespace

void pbrtWriteTable(SceneNode& node, const std::vector<double>& pairs, double scale) {
    node.word("table");
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2)
        node.child("-").number(pairs[i]).number(pbrtRounded(pairs[i + 1] * scale));
}

PbrtSpectrum PbrtSpectrum::flat(double value) {
    PbrtSpectrum s;
    s.value = value;
    return s;
}

std::string pbrtSpaceWord(std::string_view name) {
    if (name == "srgb") return "lin_rec709_scene";
    if (name == "dci-p3") return "lin_p3d65_scene";
    if (name == "rec2020") return "lin_rec2020_scene";
    if (name == "aces2065-1") return "lin_ap0_scene";
    return {};
}

std::optional<PbrtSpectrum> pbrtNamedSpectrum(std::string_view name) {
    using Kind = PbrtSpectrum::Kind;
    PbrtSpectrum s;
    const auto after = [&](std::string_view prefix) {
        return name.starts_with(prefix) ? name.substr(prefix.size()) : std::string_view();
    };
    if (const auto metal = after("metal-"); metal.ends_with("-eta") || metal.ends_with("-k")) {
        s.kind = metal.ends_with("-k") ? Kind::metalK : Kind::metalEta;
        s.name = metal.substr(0, metal.rfind('-'));
        if (s.name == "CuZn") s.name = "brass";
        if (findMetal(s.name)) return s;
    } else if (const auto glass = after("glass-"); !glass.empty()) {
        for (const PbrtGlassName& entry : kPbrtGlasses)
            if (entry.pbrt == glass) s.name = entry.ours;
        s.kind = Kind::glass;
        if (!s.name.empty() && findGlass(s.name)) return s;
    } else if (const auto light = after("stdillum-"); !light.empty()) {
        s.kind = Kind::illuminant;
        s.name = light.front() == 'F' && !light.starts_with("FL") ? "FL" + std::string(light.substr(1)) : light;
        if (findIlluminant(s.name)) return s;
    } else if (name == "illum-acesD60") {
        s.kind = Kind::illuminant;
        s.name = "D60";
        return s;
    }
    return std::nullopt;
}

std::optional<PbrtSpectrum> pbrtSpectrum(const PbrtParam& param, PbrtUse use, PbrtShared& shared) {
    if (param.type == "rgb") return pbrtColour(param, use, shared);
    if (param.type == "float" && param.numbers.size() == 1 && param.numbers[0] >= 0)
        return PbrtSpectrum::flat(param.numbers[0]);
    if (param.type == "blackbody" && param.numbers.size() == 1 && param.numbers[0] > 0) {
        PbrtSpectrum s;
        s.kind = PbrtSpectrum::Kind::blackbody;
        s.value = std::clamp(param.numbers[0], 100.0, 1e6);
        return s;
    }
    if (param.type == "spectrum") {
        if (param.texts.size() == 1) return pbrtByName(param, use, shared);
        // A single number is no form of pbrt's, but what everybody means by it is clear.
        if (param.numbers.size() == 1 && param.numbers[0] >= 0) return PbrtSpectrum::flat(param.numbers[0]);
        return pbrtTable(param, param.numbers, use, shared);
    }
    shared.faults().error("E0802", param.span,
                          fmt::format("`{}` takes a spectrum: rgb, spectrum or blackbody", param.name),
                          fmt::format("this is `{}`", param.type));
    return std::nullopt;
}

void PbrtSpectrum::write(SceneNode& node, PbrtUse use, double scale) const {
    switch (kind) {
    case Kind::flat:
        node.number(value * scale);
        return;
    case Kind::rgb:
        node.word("rgb").vector(rgb * scale);
        if (!space.empty() && space != rgb::rec709.name) node.key("space", space);
        return;
    case Kind::table:
        pbrtWriteTable(node, pairs, scale);
        return;
    case Kind::glass:
        if (use == PbrtUse::index && scale == 1) {
            node.word("glass").name(name);
            return;
        }
        break;
    default:
        break;
    }
    pbrtWriteTable(node, pbrtSampled(*curve(use)), scale);
}

std::unique_ptr<Curve> PbrtSpectrum::curve(PbrtUse use) const {
    switch (kind) {
    case Kind::flat:
        return std::make_unique<ConstantCurve>(value);
    case Kind::rgb: {
        const RgbSpace primaries = pbrtSpace(space);
        UpsampledCurve fit = use == PbrtUse::light    ? emissionFromRgb(rgb, primaries)
                             : use == PbrtUse::albedo ? reflectanceFromRgb(rgb, primaries)
                                                      : unboundedFromRgb(rgb, primaries);
        return std::move(fit.curve);
    }
    case Kind::table:
        return pbrtTableCurve(pairs, use);
    case Kind::blackbody:
        return blackbodyCurve(value);
    case Kind::illuminant:
        return illuminantCurve(*findIlluminant(name));
    case Kind::glass:
        return indexCurve(*findGlass(name));
    case Kind::metalEta:
        return indexCurve(*findMetal(name));
    case Kind::metalK:
        return extinctionCurve(*findMetal(name));
    }
    return std::make_unique<ConstantCurve>(0);
}

double PbrtSpectrum::luminance() const {
    if (kind == Kind::rgb) return toXyz(rgb, pbrtSpace(space)).y;
    return integrate(*curve(PbrtUse::light)).y;
}

bool PbrtSpectrum::isBlack() const {
    if (kind == Kind::flat) return value == 0;
    if (kind == Kind::rgb) return rgb == Vec3d();
    if (kind != Kind::table) return false;
    for (std::size_t i = 1; i < pairs.size(); i += 2)
        if (pairs[i] != 0) return false;
    return true;
}

double PbrtLight::luminance() const {
    return spectrum.kind == PbrtSpectrum::Kind::rgb ? scale * spectrum.luminance() : spectrum.isBlack() ? 0 : scale;
}

void PbrtLight::writeRadiance(SceneNode& node) const {
    if (spectrum.kind == PbrtSpectrum::Kind::rgb) return spectrum.write(node, PbrtUse::light, scale);
    const double own = spectrum.luminance();
    spectrum.write(node, PbrtUse::light, own > 0 ? scale / own : 0);
}

void PbrtLight::writeColor(SceneNode& light) const {
    if (spectrum.kind == PbrtSpectrum::Kind::illuminant && spectrum.name == "D65") return;
    if (spectrum.kind == PbrtSpectrum::Kind::rgb && spectrum.rgb.x == spectrum.rgb.y &&
        spectrum.rgb.y == spectrum.rgb.z && (spectrum.space.empty() || spectrum.space == rgb::rec709.name))
        return;
    SceneNode& color = light.child("color");
    if (spectrum.kind == PbrtSpectrum::Kind::blackbody)
        color.word("blackbody").number(spectrum.value).word("K");
    else if (spectrum.kind == PbrtSpectrum::Kind::illuminant)
        color.word("illuminant").word(spectrum.name);
    else
        spectrum.write(color, PbrtUse::light);
}

PbrtLight pbrtLight(const PbrtParams& params, std::string_view name, const std::string& colorSpace,
                    PbrtShared& shared) {
    PbrtLight light;
    light.spectrum = PbrtSpectrum::colour({1, 1, 1}); // the illuminant of the space
    light.spectrum.space = pbrtSpaceWord(colorSpace);
    if (const PbrtParam* param = params.find(name))
        if (auto spectrum = pbrtSpectrum(*param, PbrtUse::light, shared)) light.spectrum = std::move(*spectrum);
    return light;
}

} // namespace abbe::exchange
