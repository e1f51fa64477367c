#include "exchange/mitsuba/settings.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr double kSunDiameter = 0.5358; // degrees, of the disk that Mitsuba's sky has by default

// A sky's own axes are x to the south, y to the west and z up, or those of versions before 2: x east, y up, z south.
Transform skyAxes(const XmlObject& emitter) {
    const Transform up = emitter.find(kSkyWithYUp) ? Transform{} : Transform::rotate({1, 0, 0}, kPiD / 2);
    return up.then(mitsubaTransform(emitter));
}

// Where the sun is seen, to the south, to the west and up, from low-precision formulae for its place in the sky
// [Astronomical Almanac, section C]: within 0.01° for a century.
Vec3d sunOfDate(const XmlObject& emitter, Import& import) {
    const auto number = [&](const char* name, double otherwise) {
        return mitsubaNumber(emitter, name, otherwise, import);
    };
    const int year = static_cast<int>(std::clamp(number("year", 2010), 1.0, 9999.0));
    const auto month = static_cast<unsigned>(std::clamp(number("month", 7), 1.0, 12.0));
    const auto day = static_cast<unsigned>(std::clamp(number("day", 10), 1.0, 31.0));
    const double hours =
        number("hour", 15) + number("minute", 0) / 60 + number("second", 0) / 3600 - number("timezone", 9);
    const double north = number("latitude", 35.6894) * kDegree, east = number("longitude", 139.6917);
    const std::chrono::sys_days date = std::chrono::year(year) / std::chrono::month(month) / std::chrono::day(day);
    const double n = date.time_since_epoch().count() - 10957.5 + hours / 24; // days since noon of 1 January 2000
    const double anomaly = (357.528 + 0.9856003 * n) * kDegree;
    const double along =
        (280.460 + 0.9856474 * n + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2 * anomaly)) * kDegree;
    const double tilt = (23.439 - 0.0000004 * n) * kDegree;
    const double ascension = std::atan2(std::cos(tilt) * std::sin(along), std::cos(along));
    const double sinDecline = std::sin(tilt) * std::sin(along);
    const double cosDecline = std::sqrt(1 - sinDecline * sinDecline);
    const double sidereal = 15 * (18.697374558 + 24.06570982441908 * n) + east;
    const double turn = sidereal * kDegree - ascension;
    return {cosDecline * std::cos(turn) * std::sin(north) - sinDecline * std::cos(north), cosDecline * std::sin(turn),
            sinDecline * std::sin(north) + cosDecline * std::cos(turn) * std::cos(north)};
}

// In the world, of length 1; zero where that makes no sense.
Vec3d sunOf(const XmlObject& emitter, MitsubaContext& ctx) {
    Vec3d sun;
    if (const auto stated = mitsubaVector(emitter, "sun_direction", ctx.import)) {
        sun = *stated;
    } else {
        const Vec3d s = sunOfDate(emitter, ctx.import);
        sun = mitsubaTransform(emitter).vector(emitter.find(kSkyWithYUp) ? Vec3d(-s.y, s.z, s.x) : s);
    }
    return lengthSquared(sun) > 0 ? normalize(sun) : Vec3d();
}

// Sunlight on a surface that faces it, in W per m² and nm: a black body of the sun's temperature and size, through
// molecules and haze [Preetham1999, appendix A.1].
double sunlight(double nm, double airMass, double turbidity) {
    constexpr double kC1 = 1.191042972397188e-16, kC2 = 1.438776877e-2, kKelvin = 5778, kSolidAngle = 6.8e-5;
    const double metres = nm * 1e-9, micrometres = nm * 1e-3;
    const double outside = kSolidAngle * kC1 / std::pow(metres, 5) / std::expm1(kC2 / (metres * kKelvin)) * 1e-9;
    const double molecules = 0.008735 * std::pow(micrometres, -4.08);
    const double haze = std::max(0.04608 * turbidity - 0.04586, 0.0) * std::pow(micrometres, -1.3);
    return outside * std::exp(-airMass * (molecules + haze));
}

void writeSun(const XmlObject& emitter, Vec3d sun, double height, double turbidity, double factor,
              MitsubaContext& ctx) {
    // [Kasten1965]
    const double degrees = std::asin(std::clamp(height, 0.0, 1.0)) / kDegree;
    const double airMass = 1 / (std::max(height, 0.0) + 0.15 * std::pow(degrees + 3.885, -1.253));
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "sun")).word("sun");
    light.child("toward").vector(-sun);
    light.child("angular-diameter")
        .number(std::clamp(mitsubaNumber(emitter, "sun_aperture", kSunDiameter, ctx.import), 0.0, 90.0))
        .word("deg");
    double sum = 0;
    constexpr double kFirst = 360, kLast = 830, kStep = 10;
    SceneNode color("color");
    color.word("table");
    for (double nm = kFirst; nm <= kLast; nm += kStep) {
        const double value = sunlight(nm, airMass, turbidity);
        sum += kStep * value * (nm == kFirst || nm == kLast ? 0.5 : 1);
        color.child("-").number(nm).number(std::round(value * 1e5) / 1e5);
    }
    light.child("irradiance").number(factor * sum).word("W-per-m2");
    light.adopt(std::move(color));
    hideFromCamera(light, false, ctx);
}

// `sun`: where it is seen, in the sky's own axes with y up.
void writeDaylight(const XmlObject& emitter, const Transform& axes, Vec3d sun, bool shines, double scale,
                   MitsubaContext& ctx) {
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "sky")).word("daylight");
    ctx.import.approximated(&light, emitter.span, fmt::format("`{}`", emitter.plugin),
                            "by Abbe's own daylight, whose brightness and colours differ, and whose ground shines "
                            "below the horizon, where Mitsuba's sky is black");
    light.child("toward").vector(-sun);
    light.child("turbidity").number(std::clamp(mitsubaNumber(emitter, "turbidity", 3, ctx.import), 1.0, 10.0));
    MaterialTraits none;
    const XmlParam* const albedo = emitter.find("albedo");
    if (albedo && isTexture(*albedo))
        ctx.import.leftOut(&light, albedo->span, "a texture of `albedo`", "the ground is alike everywhere");
    else
        writeColor(light, "ground-albedo", emitter, "albedo", SpectrumUse::reflectance, 0.3, none, ctx);
    if (!shines) light.child("sun").word("off");
    if (scale != 1)
        ctx.import.leftOut(&light, emitter.span, fmt::format("a sky {:.4g} times as bright", scale),
                           "daylight is as bright as it is; the camera has an `exposure`");
    writeTransform(light, axes);
    hideFromCamera(light, false, ctx);
}

} // namespace

// Brightness is absolute in both programs, so that daylight stands for Mitsuba's sky as it is; what is made brighter or
// darker, or wider, is a sun of its own.
void convertSky(const XmlObject& emitter, MitsubaContext& ctx) {
    const double both = mitsubaNumber(emitter, "scale", 1, ctx.import);
    double skyScale = both * mitsubaNumber(emitter, "sky_scale", 1, ctx.import);
    double sunScale = both * mitsubaNumber(emitter, "sun_scale", 1, ctx.import);
    if (emitter.plugin == "sun") skyScale = 0;
    if (emitter.plugin == "sky") sunScale = 0;
    const double turbidity = mitsubaNumber(emitter, "turbidity", 3, ctx.import);
    const Vec3d sun = sunOf(emitter, ctx);
    const Transform axes = skyAxes(emitter);
    const auto inverse = axes.inverse();
    if (!inverse || sun == Vec3d()) {
        ctx.import.diagnostics.error("E0802", emitter.span, "the sun of this sky is nowhere");
        return;
    }
    const Vec3d local = normalize(inverse->vector(sun));
    constexpr double kLowest = -0.2; // below 12° under the horizon there is no daylight
    if (local.y < kLowest) {
        ctx.import.leftOut(nullptr, emitter.span, fmt::format("`{}`", emitter.plugin), "its sun is below the horizon");
        for (const XmlParam& param : emitter.params) param.used = true;
        return;
    }
    const double aperture = mitsubaNumber(emitter, "sun_aperture", kSunDiameter, ctx.import);
    const bool ownSun = skyScale > 0 && sunScale == 1 && std::abs(aperture - kSunDiameter) < 0.01;
    if (skyScale > 0) writeDaylight(emitter, axes, local, ownSun, skyScale, ctx);
    if (sunScale > 0 && !ownSun && local.y > 0) writeSun(emitter, sun, local.y, turbidity, sunScale, ctx);
    mitsubaIgnore(emitter,
                  {"albedo", "complex_sun", "to_world", "stretch", "resolution", "extend", "sun_radius_scale"});
    mitsubaIgnore(emitter, {"year", "month", "day", "hour", "minute", "second", "latitude", "longitude", "timezone"});
    mitsubaIgnore(emitter, {"start_year", "start_month", "start_day", "end_year", "end_month", "end_day"});
    mitsubaIgnore(emitter, {"window_start_time", "window_end_time", "shutter_open", "shutter_close"});
    if (emitter.plugin == "timed_sunsky")
        ctx.import.approximated(nullptr, emitter.span, "the mean of a sky over time", "by the sky of one moment");
}

} // namespace abbe::exchange
