// From a place on the film to a ray.
#pragma once

#include "render/ray.h"

#include <optional>

namespace abbe {

struct CameraSample {
    Vec2 film; // pixels from the upper left corner of the full frame; (0.5, 0.5) is the middle of the first pixel
    Vec2 lens; // [0, 1)²
    float time = 0;
    float wavelength = 550; // of the hero, nm
};

struct CameraRay {
    Ray ray;
    float weight = 1;      // vignetting and the like; 0: no light comes through
    bool heroOnly = false; // other wavelengths take other ways: weight and ray are the hero's alone
};

// Immutable, thread-safe. Render space has its origin at the camera (docs/conventions.md).
class Camera {
  public:
    virtual ~Camera() = default;
    virtual CameraRay ray(const CameraSample&) const noexcept = 0;
    // Where on the film the point is seen through the middle of the lens at a time (Ray::time), as CameraSample::film;
    // nothing if the camera does not look at it. Panoramas count on beyond their edges: of several places it is the
    // one nearest to `near`.
    virtual std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept {
        static_cast<void>(p), static_cast<void>(time), static_cast<void>(near);
        return std::nullopt;
    }
    // False if ray() does not look at CameraSample::lens.
    virtual bool usesLens() const { return true; }
    // True if ray() may set CameraRay::heroOnly. A scene seen by such a camera has Effect::dispersion.
    virtual bool disperses() const { return false; }
};

} // namespace abbe
