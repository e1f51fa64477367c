// Pinhole or thin lens, in the terms of real cameras or as a plain field of view.
#pragma once

#include "base/diagnostic.h"
#include "math/frame.h"
#include "math/transform.h"
#include "render/camera.h"
#include "schema/type.h"

#include <memory>
#include <optional>

namespace abbe {

// Lengths in m, angles in rad. Directions and points are those of the file.
struct PerspectiveParams {
    std::optional<Vec3d> from;          // 0 0 0
    std::optional<Vec3d> lookAt;        // one metre ahead along -z (+y in a z-up scene)
    std::optional<Vec3d> up;            // the file's up axis
    std::optional<Transform> transform; // instead of the three: camera to world, looking along its -z, up its +y
    std::optional<double> lens;         // focal length; 50 mm
    Vec2d sensor{0.036, 0.024};
    std::optional<double> fov;      // full horizontal angle, instead of `lens`
    std::optional<double> fStop;    // focal length over aperture diameter
    std::optional<double> aperture; // diameter, instead of `fStop`; without both: a pinhole
    std::optional<double> focus;    // distance of the sharp plane along the axis; the look-at point's
    double exposure = 0;            // stops; applied by the film, not by the camera
};

schema::TypeInfo perspectiveType();

// The sharp plane lies perpendicular to the axis; every lens point has the same weight.
class PerspectiveCamera final : public Camera {
  public:
    // The image spans 2 tanHalfFov at distance 1 across the film's width; pixels are square. `axes` has x to the
    // right, y up and looks along -z, in render space. A lens radius of 0 is a pinhole; the focus may be infinite.
    // Requires: tanHalfFov > 0, lensRadius >= 0, focus > 0.
    PerspectiveCamera(const Frame& axes, Vec2i filmSize, double tanHalfFov, double lensRadius, double focus);
    CameraRay ray(const CameraSample&) const noexcept override;
    bool usesLens() const override { return lensRadius_ > 0; }

  private:
    Frame axes_;
    float scale_;      // of a pixel at distance 1
    Vec2 corner_;      // of the film at distance 1
    float lensRadius_; // m
    float invFocus_;   // 1/m
};

struct CameraContext {
    Transform toWorld; // from the axes of the file: the rotation of a z-up scene
    bool zUp = false;
    Vec2i filmSize; // pixels, both > 0
    Span span;      // of the definition's head
};

struct PlacedCamera {
    std::unique_ptr<Camera> camera; // in render space: world space minus `origin`
    Vec3d origin;                   // the camera's position in world space
};

// Nothing after an error.
std::optional<PlacedCamera> makePerspective(const PerspectiveParams&, const CameraContext&, Diagnostics&);

} // namespace abbe
