// What the inside of a body absorbs and scatters, from what it is stated as: colours and lengths.
#pragma once

#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace abbe {

// Absorption stated as the colour that is left after a distance.

// σ(λ) = -ln(c(λ)) / d, 1/m: what leaves the share c(λ) after the distance d > 0, m. The colour must outlive it.
class AttenuationCurve final : public Curve {
  public:
    AttenuationCurve(const Curve& color, double distance) : color_(color), distance_(distance) {}

    Spectrum at(const Wavelengths& w) const override {
        return log(max(color_.at(w), Spectrum(static_cast<float>(kBlack)))) * static_cast<float>(-1 / distance_);
    }
    double at(double nanometres) const override { return coefficient(color_.at(nanometres)); }
    bool isConstant() const override { return color_.isConstant(); }
    double minimum() const override { return coefficient(color_.maximum()); }
    double maximum() const override { return coefficient(color_.minimum()); }

  private:
    // An exact 0 would absorb infinitely, and 0 · ∞ has no value: taken as this, as the fields' docs say.
    static constexpr double kBlack = 1e-6;
    double coefficient(double share) const { return -std::log(std::max(share, kBlack)) / distance_; }
    const Curve& color_;
    double distance_;
};

// From the colour that a translucent solid is seen in to how its inside scatters.

// The single-scattering albedo with which a deep medium of mean scattering cosine g, -1 < g < 1, sends back the share
// `color` of diffuse light. By similarity the medium has s = √((1 - α)/(1 - g α)), and van de Hulst's fit says what it
// sends back: (1 - s)(1 - 0.139 s)/(1 + 1.17 s) [Hulst1980; Kulla2017]. Of the quadratic equation for s the root is
// written so that nothing cancels near white. Within 2 % of what walks find, but for dark media that scatter backwards:
// 5.6 % too bright for 0.1 with g = -0.4 (statistical/rendering/subsurface_test).
inline double singleScatteringAlbedo(double color, double g) {
    const double b = 1.139 + 1.17 * color, c = 1 - color;
    const double s = 2 * c / (b + std::sqrt(b * b - 0.556 * c)), s2 = s * s;
    return (1 - s2) / (1 - g * s2);
}
inline Spectrum singleScatteringAlbedo(Spectrum color, float g) {
    const Spectrum one(1.f), b = fma(color, Spectrum(1.17f), Spectrum(1.139f)), c = max(one - color, Spectrum(0.f));
    const Spectrum s = 2.f * c / (b + sqrt(b * b - 0.556f * c)), s2 = s * s;
    return max((one - s2) / (one - g * s2), Spectrum(0.f));
}

// What fills a translucent solid: a homogeneous medium.
struct SubsurfaceInside {
    std::shared_ptr<const Curve> extinction; // 1/m
    std::shared_ptr<const Curve> albedo;
    double anisotropy = 0; // mean cosine of its phase function [Henyey1941]
};

// `color`: 0 … 1, of the light sent back by a deep layer in diffuse light, without what an interface reflects.
// `scale · meanFreePath`: m, between collisions, scattering and absorption alike. Both must outlive it.
SubsurfaceInside makeSubsurfaceInside(const Curve& color, const Curve& meanFreePath, double anisotropy,
                                      double scale = 1);

} // namespace abbe
