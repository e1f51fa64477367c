// A light as its maker measured it: one point, with an intensity for each direction.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "math/distribution.h"
#include "math/frame.h"
#include "math/intensity_table.h"
#include "render/light.h"

#include <memory>

namespace abbe {

// Without `power`: the intensities of the file.
struct IesLightParams : AmountParams {
    schema::Text file;
    Vec3d position;
    std::optional<Vec3d> lookAt; // a point on the axis
    std::optional<Vec3d> toward; // or its direction; without both: down
    double turn = 0;             // rad about the axis
    KeyedTransform transform;    // light to parent
};

schema::TypeInfo iesLightType();

// Intensity linear in both angles between those of the table.
class IesProfile {
  public:
    // Requires: a table as parseIes() makes them.
    explicit IesProfile(IntensityTable);

    // cd at the angle from the axis, 0 … π, and about it, any, rad.
    double candela(double fromAxis, double about) const noexcept;
    double lumens() const { return lumens_; } // ∫ I dω, exact for the interpolation

  private:
    double integrate() const;
    IntensityTable table_;
    double lumens_;
};

class IesLight final : public PlacedLight {
  public:
    // `axes`: z is the axis (down for most lights), x the plane of 0°; right-handed angles are seen from above, looking
    // along z. Spectral intensity is that of the profile in cd times `perCandela`, W·sr⁻¹·nm⁻¹; the curve outlives the
    // light.
    IesLight(Vec3 position, const Frame& axes, IesProfile, ScaledCurve perCandela);

    LightOutput output() const override {
        return {.power = power_, .visiblePower = visiblePower_, .spectrum = perCandela_.curve};
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
        return LightOrigin::at(position_, time, largestPdf_);
    }
    LightOrigin originAt(std::uint32_t, Vec3, Vec3, float time) const noexcept override {
        return LightOrigin::at(position_, time, largestPdf_);
    }
    // About in proportion to the intensity.
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override;
    float pdfDirection(const LightOrigin&, Vec3 w) const noexcept override;
    Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths&) const noexcept override;

  private:
    struct Angles {
        double fromAxis, about; // 0 … π, -π … π
    };
    Angles angles(Vec3 w) const noexcept; // w leaves the light
    Distribution2D density() const;
    float largestDensity() const;

    Vec3 position_;
    Frame axes_;
    IesProfile profile_;
    ScaledCurve perCandela_;
    Distribution2D directions_; // cells of the angle about the axis and of that from it
    float largestPdf_;
    double power_, visiblePower_;
};

// Null after an error, and for a table without light, which is a warning unless a `power` is asked of it.
std::unique_ptr<PlacedLight> makeIesLight(const IesLightParams&, IntensityTable, const LightContext&, Diagnostics&);

} // namespace abbe
