#include "cameras/spherical.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

using schema::Dimension;
using schema::field;
using schema::FieldType;

schema::TypeInfo sphericalType() {
    using P = SphericalParams;
    constexpr double kDegree = kPiD / 180;
    schema::TypeInfo type{.kind = schema::Kind::camera,
                          .name = "spherical",
                          .doc = "A panorama: longitude across, latitude upwards, over the whole sphere or a part.",
                          .example = "camera spherical { from 0 1.6 0; look-at 0 1.6 -1 }",
                          .fields = placementFields()};
    type.fields.push_back(field(FieldType::quantity, "width", &P::width)
                              .unit({Dimension::angle})
                              .byDefault("360 deg")
                              .range(0.001 * kDegree, 360 * kDegree)
                              .doc("Angle that the picture spans around the upright axis.")
                              .example("width 180 deg")
                              .synonyms({"fov", "azimuth"}));
    type.fields.push_back(field(FieldType::quantity, "height", &P::height)
                              .unit({Dimension::angle})
                              .byDefault("180 deg")
                              .range(0.001 * kDegree, 180 * kDegree)
                              .doc("Angle that the picture spans from bottom to top, half of it above the horizon.")
                              .example("height 90 deg")
                              .synonyms({"elevation"}));
    return type;
}

SphericalCamera::SphericalCamera(const Frame& axes, Vec2i filmSize, double width, double height)
    : axes_(axes), scale_{width / filmSize.x, height / filmSize.y}, corner_{-width / 2, height / 2} {
    ABBE_CHECK(filmSize.x > 0 && filmSize.y > 0 && width > 0 && height > 0);
}

CameraRay SphericalCamera::ray(const CameraSample& sample) const noexcept {
    const double longitude = corner_.x + scale_.x * static_cast<double>(sample.film.x);
    const double latitude = corner_.y - scale_.y * static_cast<double>(sample.film.y);
    const double across = std::cos(latitude);
    CameraRay result;
    result.ray.direction = normalize(
        axes_.toWorld(Vec3(Vec3d{across * std::sin(longitude), std::sin(latitude), -across * std::cos(longitude)})));
    result.ray.time = sample.time;
    return result;
}

std::optional<Vec2d> SphericalCamera::project(Vec3d p, double, Vec2d near) const noexcept {
    const Vec3d seen = axes_.toLocal(p);
    const double distance = length(seen);
    if (!(distance > 0)) return std::nullopt;
    const double longitude = std::atan2(seen.x, -seen.z);
    const double latitude = std::asin(std::clamp(seen.y / distance, -1.0, 1.0));
    const double x = (longitude - corner_.x) / scale_.x, turn = 2 * kPiD / scale_.x;
    return Vec2d{x + turn * std::round((near.x - x) / turn), (corner_.y - latitude) / scale_.y};
}

std::optional<PlacedCamera> makeSpherical(const SphericalParams& params, const CameraContext& context,
                                          Diagnostics& diagnostics) {
    const auto place = placeCamera(params, context, diagnostics);
    if (!place) return std::nullopt;
    return PlacedCamera{std::make_unique<SphericalCamera>(place->axes, context.filmSize, params.width, params.height),
                        place->origin, std::exp2(params.exposure), place->shutter, place->toWorld};
}

} // namespace abbe
