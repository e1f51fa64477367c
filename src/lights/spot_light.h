// Light from one point into a cone: even inside the inner angle, falling smoothly to nothing at the outer one.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "render/light.h"

#include <memory>

namespace abbe {

struct SpotLightParams : AmountParams {
    Vec3d position;
    std::optional<Vec3d> lookAt;      // a point on the axis
    std::optional<Vec3d> toward;      // or its direction; without both: 0 0 -1
    double angle = kPiD / 4;          // rad, full angle of the outer cone
    std::optional<double> innerAngle; // rad, full; 0.8 of `angle` when not given
    KeyedTransform transform;         // light to parent
};

schema::TypeInfo spotLightType();

class SpotLight final : public PlacedLight {
  public:
    // `axis` is a unit vector, the half angles are in rad, 0 <= inner <= outer <= π, outer > 0. Intensity on the axis
    // in W·sr⁻¹·nm⁻¹; the curve outlives the light.
    SpotLight(Vec3 position, Vec3 axis, double innerHalfAngle, double outerHalfAngle, ScaledCurve intensity);

    // ∫ falloff dω, sr.
    static double solidAngle(double innerHalfAngle, double outerHalfAngle);

    LightOutput output() const override {
        return {.power = power_, .visiblePower = visiblePower_, .spectrum = intensity_.curve};
    }
    std::optional<LightBounds> bounds(std::uint32_t) const override {
        return LightBounds{.box = {position_, position_},
                           .axis = axis_,
                           .cosNormals = 1,
                           .cosEmission = 1 - outerOneMinusCos_,
                           .power = static_cast<float>(visiblePower_)};
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    // The part of the ray within the cone.
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;

    std::optional<LightOrigin> sampleOrigin(std::uint32_t, Vec2, const Wavelengths&,
                                            float time) const noexcept override {
        return LightOrigin::at(position_, time, largestPdf());
    }
    LightOrigin originAt(std::uint32_t, Vec3, Vec3, float time) const noexcept override {
        return LightOrigin::at(position_, time, largestPdf());
    }
    // In proportion to the intensity.
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override;
    float pdfDirection(const LightOrigin&, Vec3 w) const noexcept override;
    Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths& lambda) const noexcept override {
        return intensity_.at(lambda) * falloff(w);
    }

  private:
    float falloff(Vec3 w) const noexcept; // w leaves the light
    float largestPdf() const noexcept { return 1 / (kPi * (innerOneMinusCos_ + outerOneMinusCos_)); } // solidAngle()
    Vec3 position_;
    Vec3 axis_;
    float innerOneMinusCos_;
    float outerOneMinusCos_;
    ScaledCurve intensity_;
    double power_, visiblePower_;
};

// Null after an error.
std::unique_ptr<PlacedLight> makeSpotLight(const SpotLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
