#include "cameras/perspective.h"

#include "base/check.h"
#include "math/warp.h"

namespace abbe {

namespace {

using schema::Dimension;
using schema::FieldType;

constexpr double kDegree = kPiD / 180;
constexpr double kDefaultLens = 0.05; // m

std::vector<schema::FieldInfo> placementFields() {
    return {
        schema::field(FieldType::vector3, "from", &PerspectiveParams::from)
            .unit({Dimension::length})
            .doc("Position of the lens. Default: 0 0 0.")
            .example("from 0 1 4")
            .synonyms({"position", "eye", "origin", "location"}),
        schema::field(FieldType::vector3, "look-at", &PerspectiveParams::lookAt)
            .unit({Dimension::length})
            .doc("A point in the middle of the picture. Without it the camera looks along -z (+y in a z-up scene).")
            .example("look-at 0 0.5 0")
            .synonyms({"target", "to", "at", "lookat"}),
        schema::field(FieldType::vector3, "up", &PerspectiveParams::up)
            .doc("A direction that is upright in the picture. Default: the up axis of the scene.")
            .example("up 0 1 0")
            .synonyms({"sky"}),
        schema::field(FieldType::transform, "transform", &PerspectiveParams::transform)
            .doc("Instead of `from`, `look-at` and `up`: places a camera at the origin that looks along its -z, +y up.")
            .example("transform { rotate y 30 deg; translate 0 1 4 }")
            .synonyms({"to-world", "matrix"})};
}

std::vector<schema::FieldInfo> lensFields() {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    return {schema::field(FieldType::quantity, "lens", &PerspectiveParams::lens)
                .unit({Dimension::length})
                .group("field of view")
                .range(1e-4, 100)
                .doc("Focal length. Default: 50 mm.")
                .example("lens 35 mm")
                .synonyms({"focal-length", "focallength", "focal_length"}),
            schema::field(FieldType::quantity, "fov", &PerspectiveParams::fov)
                .unit({Dimension::angle})
                .group("field of view")
                .range(0.001 * kDegree, 179.9 * kDegree)
                .doc("Full horizontal angle of view, instead of `lens`.")
                .example("fov 40 deg")
                .synonyms({"fovx", "angle", "field-of-view"})
                .note("`fov` is the full horizontal angle"),
            schema::field(FieldType::vector2, "sensor", &PerspectiveParams::sensor)
                .unit({Dimension::length})
                .byDefault("36 24 mm")
                .range(1e-6, 100)
                .doc("Width and height of the sensor. Where the film's shape differs, the width is kept.")
                .example("sensor 24 16 mm")
                .synonyms({"filmsize", "aperture-size", "sensor-width"}),
            schema::field(FieldType::number, "f-stop", &PerspectiveParams::fStop)
                .group("aperture")
                .range(0.1, kInfinite)
                .doc("Focal length over the diameter of the aperture. Without it the camera is a pinhole.")
                .example("f-stop 2.8")
                .synonyms({"fstop", "f-number", "fnumber"})
                .note("f-number = focal length / aperture diameter; to give the diameter, use `aperture 30 mm`"),
            schema::field(FieldType::quantity, "aperture", &PerspectiveParams::aperture)
                .unit({Dimension::length})
                .group("aperture")
                .range(0, 100)
                .doc("Diameter of the aperture, instead of `f-stop`; 0 is a pinhole.")
                .example("aperture 30 mm")
                .synonyms({"lensdiameter", "aperture-diameter", "lens-radius", "aperture_radius"})
                .note("for an f-number use `f-stop 2.8`"),
            schema::field(FieldType::quantity, "focus", &PerspectiveParams::focus)
                .unit({Dimension::length})
                .range(1e-6, kInfinite)
                .doc("Distance along the axis at which the picture is sharp. Default: that of `look-at`, or infinite.")
                .example("focus 2.5 m")
                .synonyms({"focus-distance", "focaldistance", "focal-distance", "focus_distance"}),
            schema::field(FieldType::quantity, "exposure", &PerspectiveParams::exposure)
                .unit({Dimension::stops})
                .byDefault("0 stops")
                .range(-100, 100)
                .doc("Brightness of the picture; each stop doubles it.")
                .example("exposure 3 stops")
                .synonyms({"ev", "gain"})};
}

// Camera to file. Nothing after a diagnostic.
std::optional<Transform> placement(const PerspectiveParams& params, const CameraContext& context,
                                   Diagnostics& diagnostics) {
    if (params.transform) {
        if (params.from || params.lookAt || params.up) {
            diagnostics.error("E0350", context.span, "the camera is placed twice",
                              "keep `transform`, or `from`, `look-at` and `up`");
            return std::nullopt;
        }
        const auto scale = params.transform->uniformScale();
        if (scale && *scale > 0 && params.transform->determinant() > 0) return params.transform;
        diagnostics.error("E0351", context.span, "a camera can be moved and turned, but not stretched or mirrored");
        return std::nullopt;
    }
    const Vec3d from = params.from.value_or(Vec3d{});
    const Vec3d to = params.lookAt.value_or(from + (context.zUp ? Vec3d{0, 1, 0} : Vec3d{0, 0, -1}));
    const Vec3d up = params.up.value_or(context.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0});
    const auto result = Transform::lookAt(from, to, up);
    if (!result)
        diagnostics.error("E0352", context.span, "the camera has no direction",
                          from == to ? "`look-at` is `from`" : "it looks along `up`");
    return result;
}

// Radius of the aperture; 0 for a pinhole.
double lensRadius(const PerspectiveParams& params, double focalLength) {
    if (params.aperture) return *params.aperture / 2;
    return params.fStop && std::isfinite(*params.fStop) ? focalLength / *params.fStop / 2 : 0;
}

double focusDistance(const PerspectiveParams& params) {
    if (params.focus) return *params.focus;
    if (!params.lookAt) return std::numeric_limits<double>::infinity();
    return length(*params.lookAt - params.from.value_or(Vec3d{}));
}

} // namespace

schema::TypeInfo perspectiveType() {
    schema::TypeInfo type{.kind = schema::Kind::camera,
                          .name = "perspective",
                          .doc = "A pinhole or thin-lens camera.",
                          .example = "camera { from 0 1 4; look-at 0 0.5 0; lens 35 mm }",
                          .isDefault = true,
                          .fields = placementFields()};
    for (schema::FieldInfo& f : lensFields()) type.fields.push_back(std::move(f));
    return type;
}

PerspectiveCamera::PerspectiveCamera(const Frame& axes, Vec2i filmSize, double tanHalfFov, double lensRadius,
                                     double focus)
    : axes_(axes), lensRadius_(static_cast<float>(lensRadius)), invFocus_(static_cast<float>(1 / focus)) {
    ABBE_CHECK(filmSize.x > 0 && filmSize.y > 0 && tanHalfFov > 0 && lensRadius >= 0 && focus > 0);
    const double scale = 2 * tanHalfFov / filmSize.x;
    scale_ = static_cast<float>(scale);
    corner_ = {static_cast<float>(-tanHalfFov), static_cast<float>(scale * filmSize.y / 2)};
}

CameraRay PerspectiveCamera::ray(const CameraSample& sample) const noexcept {
    Vec3 direction{std::fma(sample.film.x, scale_, corner_.x), std::fma(-sample.film.y, scale_, corner_.y), -1};
    CameraRay result;
    if (lensRadius_ > 0) {
        // From the lens to the point of the sharp plane that the middle of the lens sees, over its distance: an
        // infinite distance needs no case of its own.
        const Vec2 lens = squareToDisk(sample.lens) * lensRadius_;
        direction = direction - Vec3{lens.x, lens.y, 0} * invFocus_;
        result.ray.origin = axes_.toWorld({lens.x, lens.y, 0});
    }
    result.ray.direction = normalize(axes_.toWorld(direction));
    result.ray.time = sample.time;
    return result;
}

std::optional<PlacedCamera> makePerspective(const PerspectiveParams& params, const CameraContext& context,
                                            Diagnostics& diagnostics) {
    const auto toFile = placement(params, context, diagnostics);
    if (!toFile) return std::nullopt;
    const Transform toWorld = toFile->then(context.toWorld);
    const auto axis = [&](Vec3d v) { return Vec3(normalize(toWorld.vector(v))); };
    const double tanHalfFov =
        params.fov ? std::tan(*params.fov / 2) : params.sensor.x / (2 * params.lens.value_or(kDefaultLens));
    const double focalLength = params.sensor.x / (2 * tanHalfFov);
    const Frame axes{axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})};
    return PlacedCamera{std::make_unique<PerspectiveCamera>(axes, context.filmSize, tanHalfFov,
                                                            lensRadius(params, focalLength), focusDistance(params)),
                        toWorld.point({})};
}

} // namespace abbe
