// The light of a clear or hazy day, in absolute units: sky, ground below it, and the sun.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "lights/preetham_sky.h"
#include "lights/sun_direction.h"
#include "math/distribution_2d.h"
#include "render/light.h"
#include "spectrum/daylight_basis.h"

#include <memory>

namespace abbe {

struct DaylightParams : SunPlace {
    double turbidity = 3;
    const Curve* groundAlbedo = nullptr; // null: 0.2
    bool sun = true;                     // whether the disk shines; the sky is the same without
    KeyedTransform transform;            // light to parent; only its rotation matters
};

schema::TypeInfo daylightType();

// Radiance above the horizon: the luminance and chromaticity of the model with the spectrum of CIE daylight of that
// chromaticity. Directions are unit vectors with z to the zenith.
class DaylightModel {
  public:
    DaylightModel(Vec3 sun, double turbidity);

    // Factors of the daylight basis, W·m⁻²·sr⁻¹·nm⁻¹. Requires w.z > 0.
    struct Mix {
        double s0 = 0, s1 = 0, s2 = 0;
    };
    Mix mix(Vec3 w) const noexcept;
    double luminance(Vec3 w) const noexcept { return at(w).luminance; }
    Spectrum radiance(Vec3 w, const Wavelengths&) const noexcept;
    SampledCurve curve(const Mix&) const;

  private:
    PreethamSky::Value at(Vec3 w) const noexcept;
    Vec3 sun_;
    PreethamSky sky_;
    DaylightBasis basis_;
    double luminous_[3]; // of the basis, lm per W of each
};

// The sky [Preetham1999], and the light that an even ground reflects below it.
class DaylightSky final : public Light {
  public:
    // `axes`: z is the zenith. `sun` points to the sun, unit length, above the horizon. `sunlight` is the sun's
    // spectral irradiance on a surface that faces it, W·m⁻²·nm⁻¹; the ground gets it if `sunOnGround`. The albedo is
    // only read here.
    DaylightSky(const Frame& axes, Vec3 sun, double turbidity, const Curve& groundAlbedo,
                std::unique_ptr<const Curve> sunlight, bool sunOnGround);

    const Curve& sunlight() const { return *sunlight_; }

    void commit(const Bounds3&) override;
    double power() const override { return power_; }
    // As if it came from one half of all directions, from all of it alike.
    double irradiance() const override { return visibleIntegral(*totals_.fluence) / 2; }
    const Curve* powerShape() const override { return totals_.fluence.get(); }
    bool infinite() const override { return true; }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float) const noexcept override;
    LightPaths paths() const override { return power_ > 0 ? LightPaths::distant : LightPaths::none; }

  private:
    struct Totals {
        std::unique_ptr<const Curve> ground;  // radiance of the ground
        std::unique_ptr<const Curve> fluence; // ∫ L dω over all directions, W·m⁻²·nm⁻¹
    };
    static Totals totals(const DaylightModel&, const Curve& groundAlbedo, const Curve* sunlight, double sunHeight);
    Distribution2D density() const;

    Frame axes_;
    DaylightModel model_;
    std::unique_ptr<const Curve> sunlight_;
    Totals totals_;
    Distribution2D distribution_; // cells of equal solid angle: columns turn about the zenith, rows are even in height
    double radiant_;              // ∫∫ L dω dλ, W/m²
    double power_ = 0;
};

// The sky and, unless it is off, the sun; nothing after an error. The sky must live as long as the sun.
std::vector<std::unique_ptr<Light>> makeDaylight(const DaylightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
