// A shape that emits the same radiance from all its points in all directions of its outer side.
#pragma once

#include "lights/amount.h"
#include "render/light.h"
#include "render/shape.h"

#include <memory>

namespace abbe {

class AreaLight : public Light {
  public:
    // The shape is in render space; shape and curve outlive the light.
    AreaLight(const Shape&, ScaledCurve radiance, bool twoSided);

    // Infinite planes cannot be sampled: 0, so that they are never chosen.
    double power() const override { return power_; }
    double visiblePower() const override { return visiblePower_; }
    std::uint32_t parts() const override { return shape_.emitterParts(); }
    std::optional<LightBounds> bounds(std::uint32_t part) const override;
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    const Curve* powerShape() const override { return radiance_.curve; }
    // Nothing for shapes without an end.
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;
    Spectrum emitted(const SurfaceHit& hit, Vec3 w, const Wavelengths&) const noexcept override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit& hit, float) const noexcept override;
    Spectrum escaped(Vec3, const Wavelengths&, float) const noexcept override { return Spectrum(0.f); }
    float pdfEscaped(const Receiver&, Vec3, float) const noexcept override { return 0; }

  protected:
    const Shape& shape() const { return shape_; }
    Vec3 centre() const { return centre_; } // of its bounds
    // The light from a point of the shape; nothing if none arrives.
    std::optional<LightSample> arriving(const ShapeSample&, Vec3 from, const Wavelengths&) const noexcept;

  private:
    bool emits(Vec3 ng, Vec3 w) const noexcept { return twoSided_ ? dot(ng, w) != 0 : dot(ng, w) > 0; }
    const Shape& shape_;
    Vec3 centre_;
    ScaledCurve radiance_;
    double power_, visiblePower_;
    bool twoSided_;
};

struct LightContext;
struct AreaLightParams;

// A light over a shape that the caller has built. Null after an error.
std::unique_ptr<Light> makeAreaLight(const AreaLightParams&, const Shape&, const LightContext&, Diagnostics&);

} // namespace abbe
