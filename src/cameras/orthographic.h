// Parallel projection: plans, elevations, maps.
#pragma once

#include "cameras/camera_params.h"

namespace abbe {

struct OrthographicParams : CameraParams {
    std::optional<double> width, height; // of what the picture shows; one of them
};

schema::TypeInfo orthographicType();

// Rays begin in the plane of the camera and all point along its axis.
class OrthographicCamera final : public Camera {
  public:
    // `pixel` is the size of one in m. Requires: pixel > 0.
    OrthographicCamera(const Frame& axes, Vec2i filmSize, double pixel);
    CameraRay ray(const CameraSample&) const noexcept override;
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override;
    std::optional<LensConnection> connect(const LensQuery&) const noexcept override;
    float pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept override;
    bool usesLens() const override { return false; }

  private:
    Frame axes_;
    float scale_;
    Vec2 corner_;
};

// Nothing after an error.
std::optional<PlacedCamera> makeOrthographic(const OrthographicParams&, const CameraContext&, Diagnostics&);

} // namespace abbe
