#include "exchange/stated/stated_spectra.h"

#include "exchange/stated/export.h"
#include "spectrum/color_space.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace abbe::exchange {

using StatedForm = schema::SpectrumValue::Form;
using schema::SpectrumRole;

namespace {

constexpr double kFirstWavelength = 360, kLastWavelength = 830;

bool isLightRole(SpectrumRole role) {
    return role == SpectrumRole::emission || role == SpectrumRole::shape || role == SpectrumRole::tint;
}

std::optional<Vec3d> rec709Of(const StatedCurve& curve) {
    const auto& v = curve.stated;
    const Vec3d given(v.numbers[0], v.numbers[1], v.numbers[2]);
    const Vec3d c =
        v.space == schema::RgbSpaceName::linRec709 ? given : toRgb(toXyz(given, rgbSpace(v.space)), rgb::rec709);
    const double most = curve.role == SpectrumRole::albedo ? 1 : INFINITY;
    const auto within = [&](double x) { return x >= 0 && x <= most; };
    return within(c.x) && within(c.y) && within(c.z) ? std::optional(c) : std::nullopt;
}

bool isDaylight(const StatedCurve& curve) {
    return curve.stated.form == StatedForm::illuminant && findIlluminant(curve.stated.text)->name == "D65";
}

// Where the scene states a table, its own points; else even steps.
void fillTable(PlainSpectrum& out, const StatedCurve& curve, double scale, double step) {
    out.form = PlainSpectrum::Form::table;
    const auto& v = curve.stated;
    if (v.form == StatedForm::table) {
        for (std::size_t i = 0; i + 1 < v.numbers.size(); i += 2)
            out.rows.emplace_back(v.numbers[i], scale == 1 ? v.numbers[i + 1] : rounded(scale * v.numbers[i + 1]));
        return;
    }
    if (v.form == StatedForm::line || v.form == StatedForm::illuminant) step = 1; // lines are that narrow
    for (double nm = kFirstWavelength; nm <= kLastWavelength; nm += step)
        out.rows.emplace_back(nm, rounded(scale * curve.at(nm)));
}

double radiantIntegralOf(const Curve& curve) {
    double sum = 0;
    for (int nm = 360; nm < 830; ++nm) sum += (curve.at(nm) + curve.at(nm + 1)) / 2;
    return sum;
}

// The stated amount with what it is over the spectrum; nothing where none is.
std::optional<std::pair<schema::Quantity, double>> amountOf(const StatedThing& thing, const LightFactors& factors) {
    if (const auto* q = thing.quantity("power")) return std::pair{*q, factors.power};
    if (const auto* q = thing.quantity("luminance")) return std::pair{*q, 1.0};
    if (const auto* q = thing.quantity("intensity")) return std::pair{*q, 1.0};
    if (const auto* q = thing.quantity("irradiance")) return std::pair{*q, factors.irradiance};
    return std::nullopt;
}

} // namespace

double rounded(double v) { return std::strtod(fmt::format("{:.12g}", v).c_str(), nullptr); }

PlainSpectrum plainSpectrum(const StatedCurve& curve, double scale, double step) {
    PlainSpectrum out;
    out.light = isLightRole(curve.role);
    const auto times = [&](double v) { return scale == 1 ? v : rounded(scale * v); };
    const auto& v = curve.stated;
    if (v.form == StatedForm::flat && curve.role != SpectrumRole::tint) {
        out.form = PlainSpectrum::Form::flat;
        out.value = times(v.numbers[0]);
    } else if (const auto color = v.form == StatedForm::rgb ? rec709Of(curve) : std::nullopt) {
        out.rgb = {times(color->x), times(color->y), times(color->z)};
        if (!out.light && maxComponent(out.rgb) > 1) fillTable(out, curve, scale, step);
        out.form = PlainSpectrum::Form::rgb;
    } else if (out.light && isDaylight(curve)) {
        out.form = PlainSpectrum::Form::rgb; // which Rec. 709 has as its white
        out.rgb = {times(1), times(1), times(1)};
    } else if (v.form == StatedForm::blackbody && std::abs(scale - 1) < 1e-3) { // its table may have been coarser
        out.form = PlainSpectrum::Form::blackbody;
        out.value = v.numbers[0];
    } else {
        fillTable(out, curve, scale, step);
    }
    return out;
}

const LightUnits& exactUnits() {
    static const Matrix3 toXyzOf709 = rgb::rec709.toXyz();
    static const LightUnits units = {kUnitLuminance, {toXyzOf709.m[1][0], toXyzOf709.m[1][1], toXyzOf709.m[1][2]}};
    return units;
}

double luminanceOf(const StatedCurve& curve, const LightUnits& units) {
    if (curve.stated.form == StatedForm::rgb)
        if (const auto color = rec709Of(curve)) return dot(*color, units.luminance);
    if (isDaylight(curve)) return 1; // which is written as the white of Rec. 709
    return integrate(curve).y;
}

Vec3d rgbOf(const StatedCurve& curve, const StatedCurve& daylight) {
    if (curve.stated.form == StatedForm::rgb)
        if (const auto color = rec709Of(curve)) return *color;
    const auto shown = [](const Xyz& xyz) {
        const Vec3d c = toRgb(xyz, rgb::rec709);
        return Vec3d(rounded(std::max(0.0, c.x)), rounded(std::max(0.0, c.y)), rounded(std::max(0.0, c.z)));
    };
    if (isLightRole(curve.role)) return shown(integrate(curve));
    if (curve.isConstant()) return {curve.at(550), curve.at(550), curve.at(550)};
    return shown(integrate(curve, daylight));
}

std::optional<StatedLight> statedLight(const StatedThing& thing, const LightFactors& factors, const StatedScene& scene,
                                       std::optional<double> otherwise) {
    if (const StatedSpectrum radiance = thing.spectrum("radiance"); radiance.curve)
        return StatedLight{radiance.curve, 1};
    const StatedSpectrum color = thing.spectrum("color");
    const StatedCurve* const curve = color.curve ? color.curve : &scene.daylight();
    const auto amount = amountOf(thing, factors);
    if (!amount && !otherwise) return std::nullopt;
    const double factor = amount ? amount->second : 1;
    const double value = amount ? amount->first.value : *otherwise;
    const auto dimension = amount ? amount->first.dimension : schema::Dimension::luminance;
    const bool radiant = dimension == schema::Dimension::power || dimension == schema::Dimension::irradiance;
    const double total = radiant ? radiantIntegralOf(*curve) : factors.units.nits * luminanceOf(*curve, factors.units);
    if (!(total > 0 && factor > 0)) return StatedLight{curve, 0};
    return StatedLight{curve, value / (factor * total)};
}

StatedLight statedSun(const StatedThing& light, Export& to, const LightUnits& units) {
    const double half = light.number("angular-diameter", 0.53 * kDegree) / 2;
    // 100 klx on a surface that faces it, unless it says more.
    StatedLight stated = *statedLight(light, {.irradiance = 1, .units = units}, to.scene, 100000);
    if (light.has("radiance") || light.has("luminance")) stated.scale *= kPiD * std::sin(half) * std::sin(half);
    constexpr double kPoint = 0.0005 * kDegree;
    if (half > kPoint)
        to.approximated(light.span, "the width of `sun`", "its light comes from one direction, so shadows are sharp");
    return stated;
}

Vec3d sunToward(const Placed& placed, const StatedThing& light, const StatedScene& scene) {
    Vec3d toward = light.vector("toward").value_or(Vec3d());
    if (!light.has("toward")) {
        const double elevation = light.number("elevation", kPiD / 4), azimuth = light.number("azimuth", 0.75 * kPiD);
        const double east = std::cos(elevation) * std::sin(azimuth), north = std::cos(elevation) * std::cos(azimuth);
        toward = scene.zUp() ? -Vec3d(east, north, std::sin(elevation)) : -Vec3d(east, std::sin(elevation), -north);
    }
    Export::ignore(light, {"elevation", "azimuth"});
    return placed.toWorld.vector(toward);
}

std::pair<Vec3d, Vec3d> axisOfLight(const Placed& placed, const StatedThing& light) {
    const Vec3d at = light.vector("position").value_or(Vec3d());
    const auto to = light.vector("look-at");
    return {placed.toWorld.point(at),
            placed.toWorld.vector(to ? *to - at : light.vector("toward").value_or(Vec3d(0, 0, -1)))};
}

Transform mapToAxis(Vec3d place, Vec3d axis) {
    if (std::abs(length(axis) - 1) > 1e-12) axis = normalize(axis); // what is a unit vector stays as it is written
    const Vec3d x = normalize(cross(std::abs(axis.y) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0), axis)),
                y = cross(axis, x);
    Transform map;
    for (int r = 0; r < 3; ++r) {
        map.a[r][0] = rounded(x[r]);
        map.a[r][1] = rounded(y[r]);
        map.a[r][2] = axis[r];
    }
    map.t = place;
    return map;
}

double environmentScale(const StatedThing& light) {
    return light.number("luminance", kUnitLuminance) / kUnitLuminance * std::exp2(light.number("exposure", 0));
}

Transform environmentToWorld(const Placed& placed, const StatedScene& scene) {
    return scene.zUp() ? Transform::rotate({1, 0, 0}, kPiD / 2).then(placed.toWorld) : placed.toWorld;
}

double indexAtD(const StatedCurve& curve) { return rounded(curve.at(589.3)); }

} // namespace abbe::exchange
