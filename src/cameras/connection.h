// What the connections of all cameras end with.
#pragma once

#include "math/frame.h"
#include "render/camera.h"

#include <optional>

namespace abbe {

// A connection in the camera's own axes.
struct CameraConnection {
    Vec3d lens;          // on the outermost surface
    Vec3d away;          // unit, from there to the point
    double distance = 0; // m
    Vec2d film;
    double weight = 1;        // of CameraRay
    double pdfFacingArea = 0; // 1/m²
    bool heroOnly = false;
};

// Nothing where the film is missed or a number is not finite; all the rest follows from what is given.
inline std::optional<LensConnection> connection(const Frame& axes, const LensQuery& query,
                                                const CameraConnection& found) {
    LensConnection result;
    result.film = Vec2{static_cast<float>(found.film.x), static_cast<float>(found.film.y)};
    result.pdfFacingArea = static_cast<float>(found.pdfFacingArea);
    result.importance = static_cast<float>(found.weight * found.pdfFacingArea);
    const auto inside = [](float x, float lower, float upper) { return x >= lower && x < upper; };
    if (!inside(result.film.x, query.filmLower.x, query.filmUpper.x) ||
        !inside(result.film.y, query.filmLower.y, query.filmUpper.y) || !(found.distance > 0) ||
        !(result.importance > 0 && result.importance < kInfinity) || !(result.pdfFacingArea < kInfinity))
        return std::nullopt;
    result.lens = axes.toWorld(Vec3(found.lens));
    result.wi = -normalize(axes.toWorld(Vec3(found.away)));
    result.distance = static_cast<float>(found.distance);
    result.heroOnly = found.heroOnly;
    return result;
}

} // namespace abbe
