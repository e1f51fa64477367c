// A distant disk of even radiance, or a single direction when its diameter is zero.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "lights/sun_direction.h"
#include "math/frame.h"
#include "render/light.h"
#include "render/visible_field.h"

#include <memory>

namespace abbe {

struct SunLightParams : AmountParams, SunPlace, VisibleParams {
    double angularDiameter = 0.53 * kPiD / 180; // rad
    KeyedTransform transform;                   // light to parent; only its rotation matters
};

schema::TypeInfo sunLightType();

class SunLight final : public DistantLight {
  public:
    // Disks of a smaller half angle (rad) are single directions: float directions cannot resolve them.
    static constexpr double kSmallestHalfAngle = 1e-5;

    // `direction` points to the sun. Spectral irradiance in W·m⁻²·nm⁻¹ on a surface that faces it; the curve outlives
    // the light. Requires: halfAngle in [0, π/2].
    SunLight(Vec3d direction, double halfAngle, ScaledCurve irradiance);

    void commit(const Bounds3&) override;
    LightOutput output() const override {
        return {power_, LightOutput::kDaylightShare * power_, visibleIrradiance_, radiance_.curve};
    }
    bool hasExtent() const override { return !delta_; }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float) const noexcept override;

  private:
    bool inside(Vec3 w) const noexcept;
    Frame frame_; // z points to the sun
    bool delta_;
    float oneMinusCos_;    // of the half angle
    float chord_;          // from the disk's middle to its edge, on the unit sphere
    float pdf_;            // 1/sr
    ScaledCurve radiance_; // irradiance for a delta light
    double irradiance_;    // W/m²
    double visibleIrradiance_;
    double power_;
};

// Null after an error.
std::unique_ptr<DistantLight> makeSunLight(const SunLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
