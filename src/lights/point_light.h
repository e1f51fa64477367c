// Light from one point, equal in all directions.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "math/warp.h"
#include "render/light.h"

#include <memory>

namespace abbe {

struct PointLightParams : AmountParams {
    Vec3d position;
    KeyedTransform transform; // light to parent
};

schema::TypeInfo pointLightType();

class PointLight final : public PlacedLight {
  public:
    // Intensity in W·sr⁻¹·nm⁻¹; the curve outlives the light.
    PointLight(Vec3 position, ScaledCurve intensity);

    LightOutput output() const override {
        return {.power = power_, .visiblePower = visiblePower_, .spectrum = intensity_.curve};
    }
    std::optional<LightBounds> bounds(std::uint32_t) const override {
        return LightBounds{.box = {position_, position_}, .power = static_cast<float>(visiblePower_)};
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override {
        return LightReach{position_, 0, tMax};
    }

    std::optional<LightOrigin> sampleOrigin(std::uint32_t, Vec2, const Wavelengths&,
                                            float time) const noexcept override {
        return LightOrigin::at(position_, time, kSpherePdf);
    }
    LightOrigin originAt(std::uint32_t, Vec3, Vec3, float time) const noexcept override {
        return LightOrigin::at(position_, time, kSpherePdf);
    }
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override { return squareToSphere(u); }
    float pdfDirection(const LightOrigin&, Vec3) const noexcept override { return kSpherePdf; }
    Spectrum leaving(const LightOrigin&, Vec3, const Wavelengths& lambda) const noexcept override {
        return intensity_.at(lambda);
    }

  private:
    Vec3 position_;
    ScaledCurve intensity_;
    double power_, visiblePower_;
};

// Null after an error.
std::unique_ptr<PlacedLight> makePointLight(const PointLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
