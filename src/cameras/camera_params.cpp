#include "cameras/camera_params.h"

#include "spectrum/sensor.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

using schema::Dimension;
using schema::field;
using schema::FieldInfo;
using schema::FieldType;

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kSaturation = 78; // lx s at ISO 1 [ISO12232]

std::optional<Vec3d> firstOf(const std::optional<Vec3d>& a, const std::optional<Vec3d>& b) { return a ? a : b; }

// Camera to file at one moment. Nothing after a diagnostic.
std::optional<Transform> lookAt(const CameraParams& params, const CameraMoment& moment, bool zUp,
                                Diagnostics& diagnostics) {
    const Vec3d from = firstOf(moment.from, params.from).value_or(Vec3d{});
    const Vec3d to = firstOf(moment.lookAt, params.lookAt).value_or(from + (zUp ? Vec3d{0, 1, 0} : Vec3d{0, 0, -1}));
    const Vec3d up = firstOf(moment.up, params.up).value_or(zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0});
    const auto result = Transform::lookAt(from, to, up);
    if (!result)
        diagnostics.error("E0352", moment.span, "the camera has no direction",
                          from == to ? "`look-at` is `from`" : "it looks along `up`");
    return result;
}

// Rays are turned and moved, and what the lens measures stays: so must the scale, which has no meaning else.
bool isRigid(const KeyedTransform& transform, const Shutter& shutter) {
    constexpr int samples = 64;
    const auto first = transform.at(shutter.open).uniformScale();
    for (int i = 0; i <= samples; ++i) {
        const Transform m = transform.at(shutter.timeAt(static_cast<double>(i) / samples));
        const auto scale = m.uniformScale();
        if (!scale || !(*scale > 0) || !(m.determinant() > 0) || !(std::abs(*scale / *first - 1) < 1e-6)) return false;
    }
    return true;
}

// Camera to file. Nothing after a diagnostic.
std::optional<KeyedTransform> toFile(const CameraParams& params, const Shutter& shutter, const CameraContext& context,
                                     Diagnostics& diagnostics) {
    if (params.transform) {
        if (params.from || params.lookAt || params.up || !params.moments.empty()) {
            diagnostics.error("E0350", context.span, "the camera is placed twice",
                              "keep `transform`, or `from`, `look-at` and `up`");
            return std::nullopt;
        }
        if (isRigid(*params.transform, shutter)) return params.transform;
        diagnostics.error("E0351", context.span, "a camera can be moved and turned, but not stretched or mirrored");
        return std::nullopt;
    }
    if (params.moments.empty()) return lookAt(params, {0, context.span, {}, {}, {}}, context.zUp, diagnostics);
    std::vector<KeyedTransform::Key> keys;
    for (const CameraMoment& moment : params.moments) {
        const auto place = lookAt(params, moment, context.zUp, diagnostics);
        if (!place) return std::nullopt;
        keys.push_back({moment.time, {{TransformStep::Kind::matrix, {}, 0, *place}}});
    }
    return KeyedTransform(std::move(keys));
}

std::optional<KeyedTransform> posed(const CameraPose& pose, const CameraContext& context, Diagnostics& diagnostics) {
    CameraParams params;
    params.from = pose.from;
    params.lookAt = pose.lookAt;
    params.up = pose.up;
    return lookAt(params, {0, context.span, {}, {}, {}}, context.zUp, diagnostics);
}

// From the camera to what it looks at when the shutter opens; between two moments it changes evenly.
std::optional<double> lookAtDistance(const CameraParams& params, double opening) {
    std::optional<double> before;
    double timeBefore = 0;
    const auto at = [&](const CameraMoment& m) -> std::optional<double> {
        const auto to = firstOf(m.lookAt, params.lookAt);
        return to ? std::optional(length(*to - firstOf(m.from, params.from).value_or(Vec3d{}))) : std::nullopt;
    };
    if (params.moments.empty()) return at({});
    for (const CameraMoment& m : params.moments) {
        const auto distance = at(m);
        if (m.time >= opening) {
            if (!before || !distance) return distance;
            return *before + (*distance - *before) * (opening - timeBefore) / (m.time - timeBefore);
        }
        before = distance;
        timeBefore = m.time;
    }
    return before;
}

std::optional<Shutter> shutterOf(const CameraParams& params, const CameraContext& context, Diagnostics& diagnostics) {
    const Shutter shutter{params.time + context.frameTime, params.shutter.value_or(0), params.opening, params.closing};
    if (params.opening + params.closing <= 2) return shutter;
    diagnostics
        .error("E0357", context.span, "the shutter closes before it is open",
               fmt::format("`opening` and `closing` are {:.6g} together", params.opening + params.closing))
        .help = "they are parts of the exposure time, at most 2 together: a triangle";
    return std::nullopt;
}

FieldInfo momentsField() {
    using M = CameraMoment;
    const auto triple = [](std::string_view name, std::optional<Vec3d> M::*member, std::string_view doc) {
        return field(FieldType::vector3, name, member).doc(doc);
    };
    return field(FieldType::moments, "at", &CameraParams::moments)
        .doc("Where a moving camera is at a time. What a block leaves out is as the camera has it.")
        .example("at \"1/24\" s { from 0.2 1 4; look-at 0 0.5 0 }")
        .block({triple("from", &M::from, "Position of the lens.").unit({Dimension::length}).example("from 0 1 4"),
                triple("look-at", &M::lookAt, "A point in the middle of the picture.")
                    .unit({Dimension::length})
                    .example("look-at 0 0.5 0"),
                triple("up", &M::up, "A direction that is upright in the picture.").example("up 0 1 0")});
}

FieldInfo shutterField() {
    using P = CameraParams;
    return field(FieldType::quantity, "shutter", &P::shutter)
        .unit({Dimension::time})
        .range(1e-9, 1e9)
        .doc("How long the shutter is open. Brightness follows it only where `iso` is given.")
        .example("shutter \"1/48\" s { opening 0.1; closing 0.3 }")
        .synonyms({"exposure-time", "shutter-speed", "shutterspeed"})
        .block({field(FieldType::number, "opening", &P::opening)
                    .range(0, 2)
                    .doc("How long it takes to open, in units of `shutter`. It stays open longer for that, so that as "
                         "much light comes in.")
                    .example("opening 0.1"),
                field(FieldType::number, "closing", &P::closing)
                    .range(0, 2)
                    .doc("The same for closing.")
                    .example("closing 0.3")});
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
        momentsField(),
        field(FieldType::transform, "transform", &P::transform)
            .doc("Instead of `from`, `look-at` and `up`: places a camera at the origin that looks along its -z, +y up.")
            .example("transform { rotate y 30 deg; translate 0 1 4 }")
            .synonyms({"to-world", "matrix"}),
        field(FieldType::quantity, "time", &P::time)
            .unit({Dimension::time})
            .byDefault("0 s")
            .doc("When the shutter opens: which moment of the motion is shown. In an animation it counts from each "
                 "frame.")
            .example("time \"101/24\" s")
            .synonyms({"shutter-open", "shutteropen", "frame"}),
        shutterField(),
        field(FieldType::quantity, "exposure", &P::exposure)
            .unit({Dimension::stops})
            .byDefault("0 stops")
            .range(-100, 100)
            .choices({"auto"})
            .doc("Brightness of the picture; each stop doubles it. With `auto` a pilot finds the stops that show the "
                 "scene in middle grey, before the first sample; the render prints them, and the image states them.")
            .example("exposure 3 stops")
            .synonyms({"ev", "gain"})};
}

std::vector<FieldInfo> lensCameraFields() {
    using P = LensCameraParams;
    return {field(FieldType::vector2, "sensor", &P::sensor)
                .unit({Dimension::length})
                .byDefault("36 24 mm")
                .range(1e-6, 100)
                .usually(1, "mm")
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
    const auto shutter = shutterOf(params, context, diagnostics);
    if (!shutter) return std::nullopt;
    const auto inFile =
        context.pose ? posed(*context.pose, context, diagnostics) : toFile(params, *shutter, context, diagnostics);
    if (!inFile) return std::nullopt;
    const Transform toWorld = inFile->at(shutter->open).then(context.toWorld);
    const auto axis = [&](Vec3d v) { return Vec3(normalize(toWorld.vector(v))); };
    const bool moves = inFile->movesDuring(shutter->open, shutter->timeAt(1));
    return CameraPlace{toWorld.point({}), Frame{axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})},
                       context.pose ? length(context.pose->lookAt - context.pose->from)
                                    : lookAtDistance(params, shutter->open),
                       *shutter, moves ? Motion().then(*inFile).then(context.toWorld) : Motion(toWorld)};
}

std::optional<double> focusDistance(const LensCameraParams& params, const CameraPlace& place,
                                    const CameraContext& context, Diagnostics& diagnostics) {
    if (!params.focus) return place.lookAtDistance.value_or(kInfinite);
    if (params.focus->distance) return params.focus->distance;
    const Span span = params.focus->span;
    const auto middle = context.middleOf ? context.middleOf(params.focus->shape, place.shutter.open) : std::nullopt;
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

Exposure exposureOf(const CameraParams& params) { return {1, params.exposure.value, !params.exposure.word.empty()}; }

std::optional<Exposure> exposureOf(const LensCameraParams& params, std::optional<double> fNumber,
                                   const CameraContext& context, Diagnostics& diagnostics) {
    Exposure exposure = exposureOf(params);
    if (!params.iso) return exposure;
    const bool open = fNumber && std::isfinite(*fNumber);
    if (!params.shutter || !open) {
        diagnostics
            .error("E0353", context.span, "`iso` needs `shutter` and `f-stop`",
                   open             ? "`shutter` is missing"
                   : params.shutter ? "a pinhole lets no light through: `f-stop` is missing"
                                    : "both are missing")
            .help = "give all three, or leave out `iso` and use `exposure 2 stops` or `exposure auto`";
        return std::nullopt;
    }
    const double illuminance = kUnitLuminance * kPiD / (4 * *fNumber * *fNumber); // lx of Y = 1
    exposure.sensitivity = illuminance * *params.shutter * *params.iso / kSaturation;
    return exposure;
}

} // namespace abbe
