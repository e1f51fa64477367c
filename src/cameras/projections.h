// Cameras without a lens. Parallel projection: plans, elevations, maps. Panoramas in longitude and latitude.
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

struct SphericalParams : CameraParams {
    double width = 2 * kPiD; // angle around the upright axis
    double height = kPiD;    // angle from bottom to top
};

schema::TypeInfo sphericalType();

// The picture's x is longitude and its y latitude, both linear; its middle looks along the axis. A whole sphere is the
// image that `light environment` reads.
class SphericalCamera final : public Camera {
  public:
    // Requires: 0 < width <= 2π, 0 < height <= π.
    SphericalCamera(const Frame& axes, Vec2i filmSize, double width, double height);
    CameraRay ray(const CameraSample&) const noexcept override;
    std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept override;
    // Where filters reach beyond the edges of a whole sphere, a point is seen at several places: the lens numbers
    // choose.
    std::optional<LensConnection> connect(const LensQuery&) const noexcept override;
    float pdfFacingArea(const LensQuery&, const CameraRay&) const noexcept override;
    bool usesLens() const override { return false; }

  private:
    // All places of the film with one direction.
    struct Places;
    Places places(Vec3d direction, const LensQuery&) const noexcept;

    Frame axes_;
    Vec2d scale_; // rad per pixel
    Vec2d corner_;
};

// Nothing after an error.
std::optional<PlacedCamera> makeSpherical(const SphericalParams&, const CameraContext&, Diagnostics&);

} // namespace abbe
