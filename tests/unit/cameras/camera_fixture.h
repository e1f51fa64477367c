// What the camera tests share.
#pragma once

#include "cameras/camera_params.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <string>

namespace abbe::test {

inline CameraContext cameraContext(Vec2i size) {
    CameraContext context;
    context.filmSize = size;
    return context;
}

inline schema::Location at(double distance) { return {distance, {}, {}}; }

template <typename Params, typename Make> PlacedCamera made(Make make, const Params& params, Vec2i size) {
    Diagnostics diagnostics;
    auto camera = make(params, cameraContext(size), diagnostics);
    for (const Diagnostic& d : diagnostics.all()) MESSAGE(d.code << ": " << d.message);
    REQUIRE(camera);
    return std::move(*camera);
}

// The code of the only diagnostic.
template <typename Params, typename Make> std::string codeOf(Make make, const Params& params, CameraContext context) {
    Diagnostics diagnostics;
    CHECK_FALSE(make(params, context, diagnostics).has_value());
    return diagnostics.all().size() == 1 ? diagnostics.all()[0].code : "";
}

inline Vec3d exact(Vec3 v) { return Vec3d(v); }

// Where a ray meets the plane at a distance along the axis: x right and y up.
inline Vec2d meets(const Ray& r, double distance) {
    const Vec3d o = exact(r.origin), d = exact(r.direction);
    const double t = (-distance - o.z) / d.z;
    return {o.x + t * d.x, o.y + t * d.y};
}

} // namespace abbe::test
