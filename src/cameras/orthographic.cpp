#include "cameras/orthographic.h"

#include "base/check.h"
#include "cameras/connection.h"

#include <cmath>

namespace abbe {

using schema::Dimension;
using schema::field;
using schema::FieldType;

schema::TypeInfo orthographicType() {
    using P = OrthographicParams;
    schema::TypeInfo type{.kind = schema::Kind::camera,
                          .name = "orthographic",
                          .doc = "Parallel projection: sizes in the picture do not depend on distance. What lies "
                                 "behind the plane of the camera is not seen.",
                          .example = "camera orthographic { from 0 2 8; look-at 0 2 0; height 4 m }",
                          .fields = placementFields()};
    type.fields.push_back(field(FieldType::quantity, "width", &P::width)
                              .unit({Dimension::length})
                              .group("size")
                              .range(1e-9, 1e15)
                              .required()
                              .doc("Width of what the picture shows.")
                              .example("width 6 m")
                              .synonyms({"size", "screenwindow", "scale", "ortho-scale"}));
    type.fields.push_back(field(FieldType::quantity, "height", &P::height)
                              .unit({Dimension::length})
                              .group("size")
                              .range(1e-9, 1e15)
                              .required()
                              .doc("Height of what the picture shows, instead of `width`; pixels are square.")
                              .example("height 4 m"));
    return type;
}

OrthographicCamera::OrthographicCamera(const Frame& axes, Vec2i filmSize, double pixel)
    : axes_(axes), scale_(static_cast<float>(pixel)), corner_{static_cast<float>(-pixel * filmSize.x / 2),
                                                              static_cast<float>(pixel * filmSize.y / 2)} {
    ABBE_CHECK(filmSize.x > 0 && filmSize.y > 0 && pixel > 0);
}

CameraRay OrthographicCamera::ray(const CameraSample& sample) const noexcept {
    CameraRay result;
    result.ray.origin =
        axes_.toWorld({std::fma(sample.film.x, scale_, corner_.x), std::fma(-sample.film.y, scale_, corner_.y), 0});
    result.ray.direction = -axes_.z;
    result.ray.time = sample.time;
    return result;
}

std::optional<Vec2d> OrthographicCamera::project(Vec3d p, double, Vec2d) const noexcept {
    const Vec3d seen = axes_.toLocal(p);
    if (!(seen.z < 0)) return std::nullopt;
    const auto scale = static_cast<double>(scale_);
    return Vec2d{(seen.x - static_cast<double>(corner_.x)) / scale, (static_cast<double>(corner_.y) - seen.y) / scale};
}

// The direction is a delta and the place follows from p: a pixel sees the same area at any distance.
std::optional<LensConnection> OrthographicCamera::connect(const LensQuery& query) const noexcept {
    const Vec3d seen = axes_.toLocal(Vec3d(query.p));
    if (!(seen.z < 0)) return std::nullopt;
    const auto scale = static_cast<double>(scale_);
    return connection(
        axes_, query,
        {.lens = {seen.x, seen.y, 0},
         .away = {0, 0, -1},
         .distance = -seen.z,
         .film = {(seen.x - static_cast<double>(corner_.x)) / scale, (static_cast<double>(corner_.y) - seen.y) / scale},
         .pdfFacingArea = 1 / (scale * scale)});
}

float OrthographicCamera::pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept {
    return 1 / (scale_ * scale_);
}

std::optional<PlacedCamera> makeOrthographic(const OrthographicParams& params, const CameraContext& context,
                                             Diagnostics& diagnostics) {
    const auto place = placeCamera(params, context, diagnostics);
    if (!place) return std::nullopt;
    ABBE_CHECK(params.width || params.height);
    const double pixel = params.width ? *params.width / context.filmSize.x : *params.height / context.filmSize.y;
    return PlacedCamera{std::make_unique<OrthographicCamera>(place->axes, context.filmSize, pixel), place->origin,
                        exposureOf(params), place->shutter, place->toWorld};
}

} // namespace abbe
