// A camera whose shutter and movement matter, because something moves while it is open.
#pragma once

#include "cameras/shutter.h"
#include "math/motion.h"
#include "render/camera.h"

#include <memory>

namespace abbe {

// Gives the rays of another camera their time (Ray::time is the position in the shutter interval), and moves them with
// the camera as a rigid body.
class ShutterCamera final : public Camera {
  public:
    // `inner` makes rays in render space for the moment at which the shutter opens. `toRender`: camera space to render
    // space over scene time; only turns and moves.
    ShutterCamera(std::unique_ptr<const Camera> inner, const Motion& toRender, const Shutter& shutter);

    CameraRay ray(const CameraSample&) const noexcept override;
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override;
    float rayTime(float u) const noexcept override;
    std::optional<LensConnection> connect(const LensQuery&) const noexcept override;
    float pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept override;
    bool sharesLens() const override { return inner_->sharesLens(); }
    bool usesLens() const override { return inner_->usesLens(); }
    bool disperses() const override { return inner_->disperses(); }

  private:
    // From render space at the opening to there at a position of the shutter interval.
    Transform moved(double position) const { return fromOpening_.then(toRender_.at(shutter_.timeAt(position))); }

    std::unique_ptr<const Camera> inner_;
    Motion toRender_;
    Transform fromOpening_; // render space to camera space at the opening
    Shutter shutter_;
};

} // namespace abbe
