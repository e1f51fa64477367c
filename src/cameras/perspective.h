// Pinhole or thin lens, in the terms of real cameras or as a plain field of view.
#pragma once

#include "cameras/camera_params.h"

namespace abbe {

struct PerspectiveParams : LensCameraParams {
    std::optional<double> lens;     // focal length; 50 mm
    std::optional<double> fov;      // full horizontal angle, instead of `lens`
    std::optional<double> aperture; // diameter, instead of `fStop`; without both: a pinhole
    double squeeze = 1;             // of an anamorphic lens: the picture is as much wider than the sensor
    Vec2d shift;                    // of the lens on the sensor: right, up
    Vec2d tilt;                     // of the lens: down, to the right
};

schema::TypeInfo perspectiveType();

// What a thin lens does, in camera space: x right, y up, looking along -z.
struct ThinLens {
    double tanHalfFov = 1;  // of the whole width
    Aperture aperture;      // of the entrance pupil; a point: a pinhole
    double squeeze = 1;     // the pupil's width is 1/squeeze of the aperture's
    double focus = 1;       // distance of the sharp plane on the axis; may be infinite
    Vec2d shift;            // of the picture's middle at distance 1
    Vec2d tilt;             // rad: down, to the right; both below π/2
    double focalLength = 1; // m; matters only where the lens is tilted
};

// Every lens point has the same weight. The sharp plane lies perpendicular to the axis, unless the lens is tilted: with
// m its unit normal towards the sensor, a direction (x, y, -1) is sharp at the distance 1/Z = 1/Z0 - (x mx + y my) / f
// along the axis, which is Scheimpflug's plane: it meets those of lens and sensor in one line [Ray2002].
class PerspectiveCamera final : public Camera {
  public:
    // The image spans 2 tanHalfFov at distance 1 across the film's width; pixels are square. `axes` is in render space.
    // Requires: tanHalfFov > 0, focus > 0.
    PerspectiveCamera(const Frame& axes, Vec2i filmSize, const ThinLens&);
    // With a round and upright lens; a radius of 0 is a pinhole.
    PerspectiveCamera(const Frame& axes, Vec2i filmSize, double tanHalfFov, double lensRadius, double focus)
        : PerspectiveCamera(axes, filmSize, ThinLens{tanHalfFov, Aperture(lensRadius), 1, focus, {}, {}, 1}) {}
    CameraRay ray(const CameraSample&) const noexcept override;
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override;
    std::optional<LensConnection> connect(const LensQuery&) const noexcept override;
    float pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept override;
    bool usesLens() const override { return lensRadius_ > 0; }

  private:
    // What a point of the lens sees in a direction.
    struct Sight {
        Vec3d middle;       // the direction in which the middle of the lens sees the same place of the film; z = -1
        double density = 0; // pixels/sr; 0: nothing
    };

    Vec3 special(Vec2 lens, Vec3& direction) const noexcept;
    Vec3 lensPoint(Vec2 u) const noexcept;
    Sight sight(Vec3d lens, Vec3d away) const noexcept;

    Frame axes_;
    float scale_;      // of a pixel at distance 1
    Vec2 corner_;      // of the film at distance 1
    float lensRadius_; // m
    float invFocus_;   // 1/m
    bool special_;     // anything but a round lens that stands upright
    Aperture aperture_;
    float invSqueeze_;
    Vec3 lensX_, lensY_; // the plane of the lens
    Vec2 lean_;          // change of 1/Z per change of direction, 1/m
};

// Nothing after an error.
std::optional<PlacedCamera> makePerspective(const PerspectiveParams&, const CameraContext&, Diagnostics&);

} // namespace abbe
