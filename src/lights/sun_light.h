// `light sun`: its place in the sky and its light.
#pragma once

#include "base/diagnostic.h"
#include "lights/amount.h"
#include "lights/light_context.h"
#include "lights/window_light.h"
#include "math/frame.h"
#include "render/light.h"
#include "render/visible_field.h"
#include "schema/type.h"

#include <memory>
#include <optional>
#include <vector>

namespace abbe {

// Where the sun stands, as `light sun` and `light daylight` state it; by default 45° high in the south-east.
struct SunPlace {
    std::optional<Vec3d> toward;     // direction in which the light travels
    std::optional<double> elevation; // rad above the horizon
    std::optional<double> azimuth;   // rad clockwise from north, seen from above
};

// Unit vector towards the sun in the axes of the file, where north is -z and east +x, or north +y where z is up.
// Nothing after an error.
std::optional<Vec3d> sunDirection(const SunPlace&, bool zUp, Span, Diagnostics&);

// The fields of SunPlace, for the table of a type derived from it.
template <typename Params> std::vector<schema::FieldInfo> sunPlaceFields() {
    using schema::FieldType;
    using Angle = std::optional<double>;
    return {schema::field<Params, std::optional<Vec3d>>(FieldType::vector3, "toward", &Params::toward)
                .group("direction")
                .doc("Direction in which the light travels, of any length.")
                .example("toward 1 -2 0")
                .synonyms({"direction", "to"}),
            schema::field<Params, Angle>(FieldType::quantity, "elevation", &Params::elevation)
                .unit({schema::Dimension::angle})
                .range(-90 * kDegree, 90 * kDegree)
                .doc("Height above the horizon. Default: 45 deg.")
                .example("elevation 30 deg")
                .synonyms({"altitude", "sun-elevation"}),
            schema::field<Params, Angle>(FieldType::quantity, "azimuth", &Params::azimuth)
                .unit({schema::Dimension::angle})
                .range(-360 * kDegree, 360 * kDegree)
                .doc("Clockwise from north, seen from above. North is -z (+y in a z-up scene), east is +x; the sun at "
                     "90 deg stands in the east. Default: 135 deg.")
                .example("azimuth 240 deg")
                .synonyms({"sun-azimuth", "rotation"})};
}

struct SunLightParams : AmountParams, SunPlace, VisibleParams {
    double angularDiameter = 0.53 * kPiD / 180; // rad
    KeyedTransform transform;                   // light to parent; only its rotation matters
};

schema::TypeInfo sunLightType();

// A distant disk of uniform radiance, or a single direction when its diameter is zero.
class SunLight final : public DistantLight {
  public:
    // Disks of a smaller half angle (rad) are single directions: float directions cannot resolve them.
    static constexpr double kSmallestHalfAngle = 1e-5;

    // `direction` points to the sun. Spectral irradiance in W·m⁻²·nm⁻¹ on a surface that faces it; the curve outlives
    // the light. Requires: halfAngle in [0, π/2].
    SunLight(Vec3d direction, double halfAngle, ScaledCurve irradiance);

    // Lights rooms through these windows, as far as inSight() tells. They outlive it; before it is used.
    void lookThrough(const Portals& windows) { windows_ = &windows; }

    void commit(const Bounds3&) override;
    LightOutput output() const override {
        return {power_, LightOutput::kDaylightShare * power_, visibleIrradiance_, radiance_.curve};
    }
    bool hasExtent() const override { return !delta_; }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float) const noexcept override;
    float inSight(const Receiver&) const noexcept override;

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
    const Portals* windows_ = nullptr;
};

// Null after an error.
std::unique_ptr<DistantLight> makeSunLight(const SunLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
