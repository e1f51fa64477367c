// A beam: light that leaves a round opening in nearly one direction, as a laser's or a collimator's.
#pragma once

#include "lights/amount.h"
#include "lights/light_context.h"
#include "math/frame.h"
#include "render/light.h"

#include <memory>

namespace abbe {

struct BeamLightParams : AmountParams {
    Vec3d position;                                                        // the middle of the opening
    std::optional<Vec3d> lookAt;                                           // a point on the axis
    std::optional<Vec3d> toward;                                           // or its direction; without both: 0 0 -1
    double radius = 0.005;                                                 // m, of the opening
    double divergence = 0.01 * kPiD / 180;                                 // rad, full angle
    static constexpr double kLeast = kPiD / 180 * 0.005, kMost = kPiD / 2; // of it
    KeyedTransform transform;                                              // light to parent
};

schema::TypeInfo beamLightType();

// Every point of the opening emits evenly into a cone about the axis: what a lens makes of a small round source at its
// focus. No ray hits the opening.
class BeamLight final : public PlacedLight {
  public:
    // `axis` is a unit vector, the radius in m, the half angle in rad. Radiance in W·m⁻²·sr⁻¹·nm⁻¹; the curve outlives
    // the light.
    BeamLight(Vec3d centre, Vec3d axis, double radius, double halfAngle, ScaledCurve radiance);

    // ∫ cos θ dω over the cone, sr.
    static double projectedAngle(double halfAngle) { return kPiD * square(std::sin(halfAngle)); }

    LightOutput output() const override {
        return {.power = power_, .visiblePower = visiblePower_, .spectrum = radiance_.curve};
    }
    std::optional<LightBounds> bounds(std::uint32_t) const override;
    bool hasNoSurface() const override { return true; }
    // Light arrives from where the opening and the cone about the receiver overlap: points are drawn from the smaller
    // of these two disks.
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    float pdfAtPoint(const Receiver&, std::uint32_t part, Vec3 p, Vec3 n, float) const noexcept override;
    // The part of the ray within the beam.
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;

    std::optional<LightOrigin> sampleOrigin(std::uint32_t, Vec2, const Wavelengths&,
                                            float time) const noexcept override;
    LightOrigin originAt(std::uint32_t, Vec3 p, Vec3, float time) const noexcept override;
    // Even over the cone.
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override;
    float pdfDirection(const LightOrigin&, Vec3 w) const noexcept override;
    Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths&) const noexcept override;

  private:
    struct Seen; // the opening and the cone about a receiver
    std::optional<Seen> seenFrom(Vec3 p) const noexcept;
    bool inside(Vec3 w) const noexcept; // w leaves the light
    Vec3d local(Vec3d v) const { return {dot(v, x_), dot(v, y_), dot(v, z_)}; }

    Vec3d centre_, x_, y_, z_;  // z along the axis
    double radius_, tangent_;   // of the half angle
    float oneMinusCos_, chord_; // of the cone: from its axis to its edge, on the unit sphere
    ScaledCurve radiance_;
    double power_, visiblePower_;
};

// Null after an error.
std::unique_ptr<PlacedLight> makeBeamLight(const BeamLightParams&, const LightContext&, Diagnostics&);

} // namespace abbe
