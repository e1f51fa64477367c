// The same radiance from everywhere.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "lights/window_light.h"
#include "render/light.h"
#include "render/visible_field.h"

#include <memory>

namespace abbe {

// Without an amount: kDefaultSkyLuminance.
struct SkyLightParams : AmountParams, VisibleParams, PortalParams {};

inline constexpr double kDefaultSkyLuminance = 20000; // cd/m²: a bright hazy sky

schema::TypeInfo skyLightType();

class SkyLight final : public DistantLight {
  public:
    // The curve outlives the light.
    explicit SkyLight(ScaledCurve radiance);

    void commit(const Bounds3&) override;
    LightOutput output() const override {
        return {power_, LightOutput::kDaylightShare * power_, irradiance_, radiance_.curve, true};
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3, const Wavelengths& lambda, float) const noexcept override { return radiance_.at(lambda); }
    float pdfEscaped(const Receiver&, Vec3, float) const noexcept override;

  private:
    ScaledCurve radiance_;
    double radiant_;    // W·m⁻²·sr⁻¹
    double irradiance_; // as Light has it
    double power_;
};

// Null after an error.
std::unique_ptr<DistantLight> makeSkyLight(const SkyLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
