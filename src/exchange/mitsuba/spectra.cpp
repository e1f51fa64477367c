#include "exchange/mitsuba/spectra.h"

#include "exchange/mitsuba/xml_values.h"
#include "io/file.h"
#include "spectrum/curve.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

using Kind = MitsubaSpectrum::Kind;
using SpectrumRows = std::vector<std::pair<double, double>>;

constexpr double kFirstNm = 360, kLastNm = 830;

// 2hc²/λ⁵ / (exp(hc/λkT) − 1) in W per m², sr and nm [CODATA 2018].
double planckRadiance(double nm, double kelvin) {
    const double metres = nm * 1e-9;
    constexpr double kC1 = 1.191042972397188e-16, kC2 = 1.438776877e-2;
    return kC1 / std::pow(metres, 5) / std::expm1(kC2 / (metres * kelvin)) * 1e-9;
}

// Zero beyond both ends, as Mitsuba's tables are.
SpectrumRows closedRows(SpectrumRows rows) {
    if (rows.empty()) return rows;
    constexpr double kEdge = 1e-3;
    if (rows.front().first > kFirstNm && rows.front().second != 0)
        rows.insert(rows.begin(), {rows.front().first - kEdge, 0});
    if (rows.back().first < kLastNm && rows.back().second != 0) rows.emplace_back(rows.back().first + kEdge, 0);
    return rows;
}

std::optional<MitsubaSpectrum> tableOf(SpectrumRows rows, Span span, Import& import) {
    const bool ascending = std::ranges::is_sorted(rows, [](auto& a, auto& b) { return a.first <= b.first; });
    const bool positive = std::ranges::all_of(rows, [](auto& r) { return r.second >= 0 && r.first > 0; });
    if (rows.empty() || !ascending || !positive) {
        import.diagnostics.error("E0802", span,
                                 "a spectrum has ascending wavelengths and values that are not negative");
        return std::nullopt;
    }
    MitsubaSpectrum out;
    out.kind = Kind::table;
    out.rows = closedRows(std::move(rows));
    return out;
}

// Lines of a wavelength and a value.
SpectrumRows fileRows(const std::string& path) {
    const std::string text = RegularFile(path).readAll();
    SpectrumRows rows;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string line = text.substr(at, std::min(text.find('#', at), end) - at);
        at = end + 1;
        if (const auto pair = xmlNumbers(line); pair && pair->size() == 2) rows.emplace_back((*pair)[0], (*pair)[1]);
    }
    return rows;
}

std::optional<MitsubaSpectrum> spectrumFile(const XmlParam& named, MitsubaContext& ctx) {
    const auto path = findXmlFile(ctx.scene, named, ctx.import);
    return path ? tableOf(fileRows(path->string()), named.span, ctx.import) : std::nullopt;
}

// "400:0.1, 700:0.3"
std::optional<MitsubaSpectrum> inlineTable(const XmlParam& param, MitsubaContext& ctx) {
    std::string text(param.text);
    std::ranges::replace(text, ':', ' ');
    const auto numbers = xmlNumbers(text);
    if (!numbers || numbers->size() % 2 != 0) {
        ctx.import.diagnostics.error("E0802", param.span,
                                     fmt::format("`{}` is no spectrum: write `400:0.1, 700:0.3`", param.text));
        return std::nullopt;
    }
    SpectrumRows rows;
    for (std::size_t i = 0; i < numbers->size(); i += 2) rows.emplace_back((*numbers)[i], (*numbers)[i + 1]);
    return tableOf(std::move(rows), param.span, ctx.import);
}

MitsubaSpectrum flatSpectrum(double value) {
    MitsubaSpectrum out;
    out.value = value;
    return out;
}

MitsubaSpectrum rgbSpectrum(Vec3d rgb) {
    MitsubaSpectrum out;
    out.kind = Kind::rgb;
    out.rgb = rgb;
    return out;
}

std::vector<double> numberList(const XmlObject& object, std::string_view name) {
    const XmlParam* const param = object.find(name);
    if (!param) return {};
    if (!param->numbers.empty()) return {param->numbers.begin(), param->numbers.end()};
    return xmlNumbers(param->text).value_or(std::vector<double>());
}

std::optional<MitsubaSpectrum> regularTable(const XmlObject& object, MitsubaContext& ctx) {
    const std::vector<double> values = numberList(object, "values");
    const std::vector<double> range = numberList(object, "range");
    double first = mitsubaNumber(object, "wavelength_min", kFirstNm, ctx.import);
    double last = mitsubaNumber(object, "wavelength_max", kLastNm, ctx.import);
    if (range.size() >= 2) {
        first = range[0];
        last = range[1];
    }
    SpectrumRows rows;
    for (std::size_t i = 0; i < values.size(); ++i)
        rows.emplace_back(first + (last - first) * static_cast<double>(i) /
                                      std::max<double>(1, static_cast<double>(values.size()) - 1),
                          values[i]);
    return tableOf(std::move(rows), object.span, ctx.import);
}

std::optional<MitsubaSpectrum> irregularTable(const XmlObject& object, MitsubaContext& ctx) {
    if (const XmlParam* const file = object.find("filename")) return spectrumFile(*file, ctx);
    const std::vector<double> wavelengths = numberList(object, "wavelengths"), values = numberList(object, "values");
    if (wavelengths.size() != values.size()) {
        ctx.import.diagnostics.error("E0802", object.span, "`wavelengths` and `values` differ in number");
        return std::nullopt;
    }
    SpectrumRows rows;
    for (std::size_t i = 0; i < values.size(); ++i) rows.emplace_back(wavelengths[i], values[i]);
    return tableOf(std::move(rows), object.span, ctx.import);
}

MitsubaSpectrum blackbody(const XmlObject& object, MitsubaContext& ctx) {
    const double kelvin = mitsubaNumber(object, "temperature", 5000, ctx.import);
    const double scale = mitsubaNumber(object, "scale", 1, ctx.import);
    MitsubaSpectrum out;
    out.kind = Kind::blackbody;
    out.value = kelvin;
    return scale == 1 ? out : scaled(out, scale);
}

std::optional<MitsubaSpectrum> spectrumPlugin(const XmlObject& object, SpectrumUse use, MitsubaContext& ctx) {
    const std::string_view type = object.plugin;
    if (type == "uniform") {
        mitsubaIgnore(object, {"wavelength_min", "wavelength_max"});
        return flatSpectrum(mitsubaNumber(object, "value", 1, ctx.import));
    }
    if (type == "regular") return regularTable(object, ctx);
    if (type == "irregular") return irregularTable(object, ctx);
    if (type == "blackbody") return blackbody(object, ctx);
    if (type == "d65") {
        const double scale = mitsubaNumber(object, "scale", 1, ctx.import);
        const Vec3d color = mitsubaVector(object, "color", ctx.import).value_or(Vec3d(1, 1, 1));
        return rgbSpectrum(color * scale);
    }
    if (type == "srgb") {
        const Vec3d color = mitsubaVector(object, "color", ctx.import).value_or(Vec3d(0.5, 0.5, 0.5));
        return rgbSpectrum(color);
    }
    if (type == "rawconstant") {
        const XmlParam* const value = object.find("value");
        if (value && value->numbers.size() == 3)
            return rgbSpectrum({value->numbers[0], value->numbers[1], value->numbers[2]});
        return flatSpectrum(value && value->numbers.size() == 1 ? value->numbers[0] : 1);
    }
    ctx.import.leftOut(nullptr, object.span, fmt::format("spectrum `{}`", type),
                       "the language has no spectra of this kind; a flat one stands for it");
    return flatSpectrum(use == SpectrumUse::reflectance ? 0.5 : 1);
}

// A black body in the place of a reflectance, or times a factor, as a table.
MitsubaSpectrum planckTable(double kelvin, double factor) {
    MitsubaSpectrum out;
    out.kind = Kind::table;
    for (double nm = kFirstNm; nm <= kLastNm; nm += 5) out.rows.emplace_back(nm, factor * planckRadiance(nm, kelvin));
    return out;
}

} // namespace

bool isTexture(const XmlParam& param) {
    return param.object && (param.object->tag == "texture" || param.object->tag == "volume") &&
           param.object->plugin != "uniform" && param.object->plugin != "srgb";
}

std::optional<MitsubaSpectrum> readSpectrum(const XmlParam& param, SpectrumUse use, MitsubaContext& ctx) {
    if (isTexture(param) || param.tag == kBrokenTag) return std::nullopt;
    if (param.object) {
        auto found = spectrumPlugin(*param.object, use, ctx);
        warnOfUnused(*param.object, ctx.import);
        return found;
    }
    if (param.tag == "blackbody") {
        std::string text(param.text);
        std::erase_if(text, [](char c) { return c == 'K' || c == 'k'; });
        const auto kelvin = xmlNumbers(text);
        if (!kelvin || kelvin->size() != 1) {
            ctx.import.diagnostics.error("E0802", param.span, "a black body has one temperature");
            return std::nullopt;
        }
        MitsubaSpectrum out;
        out.kind = Kind::blackbody;
        out.value = (*kelvin)[0];
        return out;
    }
    if (param.tag == "spectrum-file") return spectrumFile(param, ctx);
    if (param.tag == "spectrum" && param.numbers.empty()) return inlineTable(param, ctx);
    if (param.tag == "spectrum") return flatSpectrum(param.numbers[0]);
    if (param.numbers.size() == 3) {
        const Vec3d rgb(param.numbers[0], param.numbers[1], param.numbers[2]);
        if (use != SpectrumUse::light && rgb.x == rgb.y && rgb.y == rgb.z) return flatSpectrum(rgb.x);
        return rgbSpectrum(rgb);
    }
    if (param.numbers.size() == 1) {
        // A <float> of a light is that much of D65.
        const double v = param.numbers[0];
        return use == SpectrumUse::light ? rgbSpectrum({v, v, v}) : flatSpectrum(v);
    }
    ctx.import.diagnostics.error("E0802", param.span, fmt::format("`{}` is no spectrum", param.name));
    return std::nullopt;
}

MitsubaSpectrum scaled(MitsubaSpectrum s, double factor) {
    if (factor == 1) return s;
    if (s.kind == Kind::blackbody) return planckTable(s.value, factor);
    s.value *= factor;
    s.rgb = s.rgb * factor;
    for (auto& row : s.rows) row.second *= factor;
    return s;
}

void writeSpectrum(SceneNode& property, MitsubaSpectrum s, SpectrumUse use, Span span, MitsubaContext& ctx) {
    bool clamped = false;
    const double most = use == SpectrumUse::reflectance ? 1 : 1e30;
    const auto within = [&](double v) {
        clamped = clamped || v > most || v < 0;
        return std::clamp(v, 0.0, most);
    };
    if (s.kind == Kind::blackbody && use != SpectrumUse::light) s = planckTable(s.value, 1);
    if (s.kind == Kind::blackbody)
        property.word("blackbody").number(std::clamp(s.value, 100.0, 1e6)).word("K");
    else if (s.kind == Kind::flat)
        property.number(within(s.value));
    else if (s.kind == Kind::rgb)
        property.word("rgb").vector({within(s.rgb.x), within(s.rgb.y), within(s.rgb.z)});
    else {
        property.word("table");
        for (const auto& [nm, value] : s.rows) property.child("-").number(nm).number(within(value));
    }
    if (clamped)
        ctx.import.approximated(nullptr, span, "this spectrum",
                                use == SpectrumUse::reflectance
                                    ? "more than 1 is reflected nowhere: values are cut to 0 … 1"
                                    : "values below 0 become 0");
}

double luminanceOf(const MitsubaSpectrum& s) {
    switch (s.kind) {
    case Kind::flat:
        return s.value;
    case Kind::rgb:
        return 0.2126 * s.rgb.x + 0.7152 * s.rgb.y + 0.0722 * s.rgb.z; // Rec. 709
    case Kind::blackbody:
        return luminanceOf(planckTable(s.value, 1));
    case Kind::table:
        break;
    }
    std::vector<double> nm, values;
    for (const auto& [wavelength, value] : s.rows) {
        nm.push_back(wavelength);
        values.push_back(value);
    }
    return integrate(SampledCurve::fromEmissionPoints(nm, values)).y;
}

} // namespace abbe::exchange
