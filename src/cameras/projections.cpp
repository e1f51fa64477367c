#include "cameras/projections.h"

#include "base/check.h"
#include "cameras/connection.h"

#include <algorithm>
#include <array>
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
    const double own = params.width ? *params.width / context.filmSize.x : *params.height / context.filmSize.y;
    const double pixel = own * (context.pose ? context.pose->size : 1);
    return PlacedCamera{std::make_unique<OrthographicCamera>(place->axes, context.filmSize, pixel),
                        place->origin,
                        exposureOf(params),
                        place->shutter,
                        place->toWorld,
                        place->lookAtDistance};
}

schema::TypeInfo sphericalType() {
    using P = SphericalParams;
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

// Turns about the upright axis repeat across, and so do those over a pole, which show the other side of it.
struct SphericalCamera::Places {
    struct Row {
        double x = 0, y = 0; // of the first one
        double count = 0;    // with one turn from each to the next
    };
    std::array<Row, 3> rows;
    double turn = 0;    // pixels
    double count = 0;   // of all
    double density = 0; // of each, pixels/sr

    Vec2d at(double index) const {
        for (const Row& r : rows) {
            if (index < r.count) return {r.x + turn * index, r.y};
            index -= r.count;
        }
        return {rows[0].x, rows[0].y};
    }
};

SphericalCamera::Places SphericalCamera::places(Vec3d w, const LensQuery& query) const noexcept {
    const double longitude = std::atan2(w.x, -w.z), across = std::hypot(w.x, w.z), latitude = std::atan2(w.y, across);
    Places result;
    result.turn = 2 * kPiD / scale_.x;
    result.density = 1 / (across * scale_.x * scale_.y);
    const std::array<Vec2d, 3> angles{
        Vec2d{longitude, latitude}, {longitude + kPiD, kPiD - latitude}, {longitude + kPiD, -kPiD - latitude}};
    const Vec2d lower{static_cast<double>(query.filmLower.x), static_cast<double>(query.filmLower.y)};
    const Vec2d upper{static_cast<double>(query.filmUpper.x), static_cast<double>(query.filmUpper.y)};
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const double x = (angles[i].x - corner_.x) / scale_.x, y = (corner_.y - angles[i].y) / scale_.y;
        if (!(y >= lower.y && y < upper.y)) continue;
        const double first = std::ceil((lower.x - x) / result.turn), end = std::ceil((upper.x - x) / result.turn);
        result.rows[i] = {x + first * result.turn, y, std::max(0.0, end - first)};
        result.count += result.rows[i].count;
    }
    return result;
}

std::optional<LensConnection> SphericalCamera::connect(const LensQuery& query) const noexcept {
    const Vec3d way = axes_.toLocal(Vec3d(query.p));
    const double distance = length(way);
    const Vec3d away = way * (1 / distance);
    const Places found = places(away, query);
    if (!(found.count > 0)) return std::nullopt;
    const double index = std::min(std::floor(static_cast<double>(query.lens.x) * found.count), found.count - 1);
    return connection(axes_, query,
                      {.lens = {},
                       .away = away,
                       .distance = distance,
                       .film = found.at(index),
                       .pdfFacingArea = found.count * found.density / (distance * distance)});
}

float SphericalCamera::pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept {
    const Places found = places(axes_.toLocal(Vec3d(ray.ray.direction)), query);
    return static_cast<float>(found.count * found.density / lengthSquared(Vec3d(query.p)));
}

std::optional<PlacedCamera> makeSpherical(const SphericalParams& params, const CameraContext& context,
                                          Diagnostics& diagnostics) {
    const auto place = placeCamera(params, context, diagnostics);
    if (!place) return std::nullopt;
    return PlacedCamera{std::make_unique<SphericalCamera>(place->axes, context.filmSize, params.width, params.height),
                        place->origin,
                        exposureOf(params),
                        place->shutter,
                        place->toWorld,
                        place->lookAtDistance};
}

} // namespace abbe
