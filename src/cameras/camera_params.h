// What the cameras of the language have in common: where they stand, what they focus on and how they expose.
#pragma once

#include "base/diagnostic.h"
#include "cameras/exposure.h"
#include "math/frame.h"
#include "math/motion.h"
#include "render/camera.h"
#include "schema/type.h"

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

namespace abbe {

// Where the camera is at a time; what is not given is as CameraParams has it.
struct CameraMoment {
    double time = 0; // s
    Span span;
    std::optional<Vec3d> from, lookAt, up;
};

// Lengths in m, angles in rad, times in s. Directions and points are those of the file.
struct CameraParams {
    std::optional<Vec3d> from;         // 0 0 0
    std::optional<Vec3d> lookAt;       // one metre ahead along -z (+y in a z-up scene)
    std::optional<Vec3d> up;           // the file's up axis
    std::vector<CameraMoment> moments; // of the three, at increasing times
    // Instead of all these: camera to world, looking along its -z, up its +y.
    std::optional<KeyedTransform> transform;
    double time = 0;                 // when the shutter opens
    std::optional<double> shutter;   // how long it is open: see Shutter::exposure
    double opening = 0, closing = 0; // its ramps, in units of that
    schema::QuantityOrWord exposure; // stops, or `auto`; applied by the film, not by the camera
};

// A camera with a sensor behind a lens.
struct LensCameraParams : CameraParams {
    Vec2d sensor{0.036, 0.024};
    std::optional<double> fStop; // focal length over the diameter of the entrance pupil
    std::int64_t blades = 0;     // 0: a circle
    double bladeRotation = 0;
    double bladeRoundness = 0;
    std::optional<schema::Location> focus; // of the sharp plane along the axis; the look-at point's
    std::optional<double> iso;
};

// Fields of the structs above, for any struct derived from them alone.
std::vector<schema::FieldInfo> placementFields(); // and `time`, `shutter` and `exposure`
std::vector<schema::FieldInfo> lensCameraFields();
schema::FieldInfo fStopField(std::string_view doc); // with the block of its blades

// Where a camera stands in place of what the scene says, in the axes of the scene, m. It does not move there.
struct CameraPose {
    Vec3d from, lookAt, up;
    double size = 1; // of what a camera without a vanishing point shows, in units of its own
};

struct CameraContext {
    Transform toWorld; // from the axes of the file: the rotation of a z-up scene
    bool zUp = false;
    Vec2i filmSize;       // pixels, both > 0
    Span span;            // of the definition's head
    double frameTime = 0; // s, of the frame that is shown; comes to the camera's own time
    // Middle of the bounds of a named shape in world space at a time; nothing if that shape has no size or place.
    std::function<std::optional<Vec3d>(std::string_view, double)> middleOf = {};
    std::optional<CameraPose> pose = {}; // there it is to stand
};

struct PlacedCamera {
    std::unique_ptr<Camera> camera; // in render space: world space minus `origin`
    Vec3d origin;                   // the camera's position in world space
    Exposure exposure;
    Shutter shutter;
    Motion toWorld;                            // of camera space; moves only if it does so while the shutter is open
    std::optional<double> lookAtDistance = {}; // m, if it is told what to look at
};

// A camera's place in world space and its axes when the shutter opens: x right, y up, looking along -z.
struct CameraPlace {
    Vec3d origin;
    Frame axes;
    std::optional<double> lookAtDistance;
    Shutter shutter;
    Motion toWorld; // as for PlacedCamera
};
// Nothing after an error.
std::optional<CameraPlace> placeCamera(const CameraParams&, const CameraContext&, Diagnostics&);

// Distance of the sharp plane along the axis; infinite without `focus` and `look-at`. Nothing after an error.
std::optional<double> focusDistance(const LensCameraParams&, const CameraPlace&, const CameraContext&, Diagnostics&);

// The opening whose circle of equal area has `radius`. Nothing after an error.
std::optional<Aperture> apertureOf(const LensCameraParams&, double radius, const CameraContext&, Diagnostics&);

// Of a camera without a lens.
Exposure exposureOf(const CameraParams&);
// The sensitivity is 1 without `iso`. With it, a pixel of 1 is the exposure that saturates a sensor of that speed,
// H_sat = 78 lx s / ISO [ISO12232], where a lens of f-number N gives H = t L π / (4 N²). A missing f-number is an
// infinite one. Nothing after an error.
std::optional<Exposure> exposureOf(const LensCameraParams&, std::optional<double> fNumber, const CameraContext&,
                                   Diagnostics&);

} // namespace abbe
