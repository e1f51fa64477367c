// A curve that goes no higher than this.
#pragma once

#include "spectrum/curve.h"

#include <algorithm>

namespace abbe {

// The other curve must outlive it.
class LimitedCurve final : public Curve {
  public:
    LimitedCurve(const Curve& other, double most) : other_(other), most_(most) {}
    Spectrum at(const Wavelengths& lambda) const override {
        return min(other_.at(lambda), Spectrum(static_cast<float>(most_)));
    }
    double at(double nm) const override { return std::min(other_.at(nm), most_); }
    bool isConstant() const override { return other_.isConstant(); }
    double minimum() const override { return std::min(other_.minimum(), most_); }
    double maximum() const override { return std::min(other_.maximum(), most_); }

  private:
    const Curve& other_;
    double most_;
};

} // namespace abbe
