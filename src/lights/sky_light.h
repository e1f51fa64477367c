// The same radiance from everywhere.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "render/light.h"
#include "render/visible_field.h"

#include <memory>

namespace abbe {

// Without an amount: kDefaultSkyLuminance.
struct SkyLightParams : AmountParams, VisibleParams {};

inline constexpr double kDefaultSkyLuminance = 20000; // cd/m²: a bright hazy sky

schema::TypeInfo skyLightType();

class SkyLight final : public Light {
  public:
    // The curve outlives the light.
    explicit SkyLight(ScaledCurve radiance);

    void commit(const Bounds3&) override;
    double power() const override { return power_; }
    double irradiance() const override { return irradiance_; }
    const Curve* powerShape() const override { return radiance_.curve; }
    bool infinite() const override { return true; }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3, const Wavelengths& lambda, float) const noexcept override { return radiance_.at(lambda); }
    float pdfEscaped(const Receiver&, Vec3, float) const noexcept override;
    LightPaths paths() const override { return power_ > 0 ? LightPaths::distant : LightPaths::none; }

  private:
    ScaledCurve radiance_;
    double radiant_;    // W·m⁻²·sr⁻¹
    double irradiance_; // as Light has it
    double power_;
};

// Null after an error.
std::unique_ptr<Light> makeSkyLight(const SkyLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
