#include "lights/sun_direction.h"

#include <cmath>

namespace abbe {

std::optional<Vec3d> sunDirection(const SunPlace& place, bool zUp, Span span, Diagnostics& diagnostics) {
    if (place.toward && (place.elevation || place.azimuth)) {
        diagnostics.error("E0346", span, "the sun's direction is stated twice",
                          "keep `toward`, or `elevation` and `azimuth`");
        return std::nullopt;
    }
    if (place.toward) {
        const double norm = length(*place.toward);
        if (norm > 0 && std::isfinite(norm)) return *place.toward * (-1 / norm);
        diagnostics.error("E0344", span, "the sun has no direction", "`toward` is zero");
        return std::nullopt;
    }
    const double elevation = place.elevation.value_or(kPiD / 4), azimuth = place.azimuth.value_or(0.75 * kPiD);
    const double east = std::cos(elevation) * std::sin(azimuth), north = std::cos(elevation) * std::cos(azimuth);
    const double up = std::sin(elevation);
    return zUp ? Vec3d{east, north, up} : Vec3d{east, up, -north};
}

} // namespace abbe
