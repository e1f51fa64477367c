// The light of a cloudless day or its twilight, in absolute units: sky, ground below it, and the sun.
#pragma once

#include "lights/amount.h"
#include "lights/clear_sky.h"
#include "lights/light_context.h"
#include "lights/sun_light.h"
#include "lights/window_light.h"
#include "math/distribution.h"
#include "render/light.h"
#include "render/visible_field.h"
#include "spectrum/curve.h"

#include <memory>

namespace abbe {

struct DaylightParams : SunPlace, VisibleParams, PortalParams {
    double turbidity = 3;
    double ozone = 300;                  // Dobson units
    const Curve* groundAlbedo = nullptr; // null: 0.2
    bool sun = true;                     // whether the disk emits; the sky is the same without
    KeyedTransform transform;            // light to parent; only its rotation matters
};

schema::TypeInfo daylightType();

// The sky of ClearSky, and the light that an even ground reflects below it.
class DaylightSky final : public DistantLight {
  public:
    // The lowest sun, rad: what is left of its light below that is less than the night's own.
    static constexpr double kLowestSun = -12 * kPiD / 180;

    // `axes`: z is the zenith, x lies on the sun's side. `sunElevation` in rad, from kLowestSun. The ground gets
    // sunlight if `sunOnGround`. The albedo is only read here.
    DaylightSky(const Frame& axes, double sunElevation, const AirParams&, const Curve& groundAlbedo, bool sunOnGround);

    const Curve& sunlight() const { return *sunlight_; } // irradiance on a surface that faces the sun, W·m⁻²·nm⁻¹

    void commit(const Bounds3&) override;
    // The irradiance is as if it came from one half of all directions, from all of it alike.
    LightOutput output() const override {
        return {power_, LightOutput::kDaylightShare * power_, visibleFluence_ / 2, totals_.fluence.get()};
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float) const noexcept override;

  private:
    struct Totals {
        std::shared_ptr<const Curve> ground;  // radiance of the ground
        std::shared_ptr<const Curve> fluence; // ∫ L dω over all directions, W·m⁻²·nm⁻¹
    };
    Totals totals(const Curve& groundAlbedo, double sunHeight) const;
    Distribution2D tabulate() const;
    // Of all samples, those that go below the horizon, where a receiver has no say and where it has one.
    double groundShare(const Receiver&) const noexcept;
    float density(Vec3 w, double ground) const noexcept;

    Frame axes_;
    ClearSky sky_;
    SampledCurve source_; // what values of sky_ are times of
    std::shared_ptr<const Curve> sunlight_;
    Totals totals_;
    Distribution2D distribution_; // cells of equal solid angle: columns turn about the zenith, rows are even in height
    double groundShare_;          // of its probability: the rows below the horizon
    double radiant_;              // ∫∫ L dω dλ, W/m²
    double visibleFluence_;       // weighted as LightOutput::visiblePower
    double power_ = 0;
};

// The sky and, unless it is off, the sun; nothing after an error. The sky must live as long as the sun.
std::vector<std::unique_ptr<DistantLight>> makeDaylight(const DaylightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
