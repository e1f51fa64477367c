#include "cameras/camera_params.h"

#include "spectrum/observer.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

using schema::Dimension;
using schema::field;
using schema::FieldInfo;
using schema::FieldType;

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kUnitLuminance = kLuminousEfficacy * kYIntegral; // cd/m² of Y = 1
constexpr double kSaturation = 78;                                // lx s at ISO 1 [ISO12232]

// Camera to file. Nothing after a diagnostic.
std::optional<Transform> toFile(const CameraParams& params, const CameraContext& context, Diagnostics& diagnostics) {
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

} // namespace

std::vector<FieldInfo> placementFields() {
    using P = CameraParams;
    return {
        field(FieldType::vector3, "from", &P::from)
            .unit({Dimension::length})
            .doc("Position of the lens. Default: 0 0 0.")
            .example("from 0 1 4")
            .synonyms({"position", "eye", "origin", "location"}),
        field(FieldType::vector3, "look-at", &P::lookAt)
            .unit({Dimension::length})
            .doc("A point in the middle of the picture. Without it the camera looks along -z (+y in a z-up scene).")
            .example("look-at 0 0.5 0")
            .synonyms({"target", "to", "at", "lookat"}),
        field(FieldType::vector3, "up", &P::up)
            .doc("A direction that is upright in the picture. Default: the up axis of the scene.")
            .example("up 0 1 0")
            .synonyms({"sky"}),
        field(FieldType::transform, "transform", &P::transform)
            .doc("Instead of `from`, `look-at` and `up`: places a camera at the origin that looks along its -z, +y up.")
            .example("transform { rotate y 30 deg; translate 0 1 4 }")
            .synonyms({"to-world", "matrix"}),
        field(FieldType::quantity, "shutter", &P::shutter)
            .unit({Dimension::time})
            .range(1e-9, 1e9)
            .doc("How long the shutter is open. Brightness follows it only where `iso` is given.")
            .example("shutter \"1/48\" s")
            .synonyms({"exposure-time", "shutter-speed", "shutterspeed"}),
        field(FieldType::quantity, "exposure", &P::exposure)
            .unit({Dimension::stops})
            .byDefault("0 stops")
            .range(-100, 100)
            .doc("Brightness of the picture; each stop doubles it.")
            .example("exposure 3 stops")
            .synonyms({"ev", "gain"})};
}

std::vector<FieldInfo> lensCameraFields() {
    using P = LensCameraParams;
    return {field(FieldType::vector2, "sensor", &P::sensor)
                .unit({Dimension::length})
                .byDefault("36 24 mm")
                .range(1e-6, 100)
                .doc("Width and height of the sensor. Where the film's shape differs, the width is kept.")
                .example("sensor 24 16 mm")
                .synonyms({"filmsize", "aperture-size", "sensor-width"}),
            field(FieldType::place, "focus", &P::focus)
                .unit({Dimension::length})
                .range(1e-6, kInfinite)
                .key({"on", {}, "Name of a shape: its distance is that of the middle of its bounds, along the axis."})
                .doc("Distance along the axis at which the picture is sharp. Default: that of `look-at`, or infinite.")
                .example("focus 2.5 m")
                .synonyms({"focus-distance", "focaldistance", "focal-distance", "focus_distance"}),
            field(FieldType::number, "iso", &P::iso)
                .range(0.01, 1e9)
                .doc("Speed of the sensor: with `shutter` and `f-stop`, a pixel of 1 is what saturates it, 78 lx s / "
                     "ISO. Without it the picture shows radiance.")
                .example("iso 400")
                .synonyms({"sensitivity", "film-speed", "asa"})};
}

FieldInfo fStopField(std::string_view doc) {
    using P = LensCameraParams;
    return field(FieldType::number, "f-stop", &P::fStop)
        .group("aperture")
        .range(0.1, kInfinite)
        .doc(doc)
        .example("f-stop 2.8 { blades 9; rotation 12 deg }")
        .synonyms({"fstop", "f-number", "fnumber"})
        .note("f-number = focal length / aperture diameter; to give the diameter, use `aperture 30 mm`")
        .block({field(FieldType::integer, "blades", &P::blades)
                    .range(3, 1000)
                    .doc("Corners of the aperture; its area stays that of the circle. Without it a circle.")
                    .example("blades 9"),
                field(FieldType::quantity, "rotation", &P::bladeRotation)
                    .unit({Dimension::angle})
                    .doc("Turns the blades counter-clockwise in the picture; at 0 a corner is upright.")
                    .example("rotation 12 deg"),
                field(FieldType::number, "roundness", &P::bladeRoundness)
                    .range(0, 1)
                    .doc("0: straight blades; 1: a circle.")
                    .example("roundness 0.3")});
}

std::optional<CameraPlace> placeCamera(const CameraParams& params, const CameraContext& context,
                                       Diagnostics& diagnostics) {
    const auto inFile = toFile(params, context, diagnostics);
    if (!inFile) return std::nullopt;
    const Transform toWorld = inFile->then(context.toWorld);
    const auto axis = [&](Vec3d v) { return Vec3(normalize(toWorld.vector(v))); };
    return CameraPlace{toWorld.point({}), Frame{axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})}};
}

std::optional<double> focusDistance(const LensCameraParams& params, const CameraPlace& place,
                                    const CameraContext& context, Diagnostics& diagnostics) {
    if (!params.focus) return params.lookAt ? length(*params.lookAt - params.from.value_or(Vec3d{})) : kInfinite;
    if (params.focus->distance) return params.focus->distance;
    const Span span = params.focus->span;
    const auto middle = context.middleOf ? context.middleOf(params.focus->shape) : std::nullopt;
    if (!middle) {
        diagnostics
            .error("E0354", span, fmt::format("nothing can be focused on `{}`", params.focus->shape),
                   "has no place of its own")
            .help = "the shape must be finite and not part of an `object`; or state the distance: `focus 2.5 m`";
        return std::nullopt;
    }
    const double distance = -dot(*middle - place.origin, Vec3d(place.axes.z));
    if (distance > 1e-6) return distance;
    diagnostics.error("E0354", span, fmt::format("`{}` lies behind the camera", params.focus->shape),
                      "cannot be in focus");
    return std::nullopt;
}

std::optional<Aperture> apertureOf(const LensCameraParams& params, double radius, const CameraContext& context,
                                   Diagnostics& diagnostics) {
    if (params.blades > 0)
        return Aperture(radius, static_cast<int>(params.blades), params.bladeRotation, params.bladeRoundness);
    if (params.bladeRotation == 0 && params.bladeRoundness == 0) return Aperture(radius);
    diagnostics.error("E0353", context.span, "an aperture without `blades` is a circle",
                      "`rotation` and `roundness` belong to blades");
    return std::nullopt;
}

std::optional<double> exposureFactor(const LensCameraParams& params, std::optional<double> fNumber,
                                     const CameraContext& context, Diagnostics& diagnostics) {
    const double gain = std::exp2(params.exposure);
    if (!params.iso) return gain;
    const bool open = fNumber && std::isfinite(*fNumber);
    if (!params.shutter || !open) {
        diagnostics
            .error("E0353", context.span, "`iso` needs `shutter` and `f-stop`",
                   open             ? "`shutter` is missing"
                   : params.shutter ? "a pinhole lets no light through: `f-stop` is missing"
                                    : "both are missing")
            .help = "give all three, or leave out `iso` and use `exposure 2 stops`";
        return std::nullopt;
    }
    const double illuminance = kUnitLuminance * kPiD / (4 * *fNumber * *fNumber); // lx of Y = 1
    return gain * illuminance * *params.shutter * *params.iso / kSaturation;
}

} // namespace abbe
