// What tests of media are made of.
#pragma once

#include "media/medium_optics.h"
#include "media/phase_functions.h"
#include "spectrum/curve.h"
#include "volumes/voxel_grid.h"

#include <algorithm>
#include <memory>

namespace abbe::test {

// A straight line from `low` at 360 nm to `high` at 830 nm.
class SlopeCurve final : public Curve {
  public:
    SlopeCurve(double low, double high) : low_(low), high_(high) {}
    Spectrum at(const Wavelengths& w) const override {
        Spectrum s;
        for (int i = 0; i < kLanes; ++i) s.v[i] = static_cast<float>(at(static_cast<double>(w.nm[i])));
        return s;
    }
    double at(double nm) const override { return low_ + (high_ - low_) * (nm - 360) / 470; }
    bool isConstant() const override { return low_ == high_; }
    double minimum() const override { return std::min(low_, high_); }
    double maximum() const override { return std::max(low_, high_); }

  private:
    double low_, high_;
};

// The curves must outlive it. Scatters by Henyey and Greenstein.
inline MediumOptics opticsOf(const Curve& extinction, const Curve& albedo, double g = 0) {
    MediumOptics o;
    o.extinction = &extinction;
    o.albedo = &albedo;
    o.phase = std::make_shared<HenyeyGreenstein>(g);
    return o;
}

inline GridFacts fogAt(const Transform& place) {
    GridFacts f;
    f.volumeClass = VolumeClass::fog;
    f.indexToWorld = place;
    return f;
}

} // namespace abbe::test
