// Absorption stated as the colour that is left after a distance.
#pragma once

#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>

namespace abbe {

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

} // namespace abbe
