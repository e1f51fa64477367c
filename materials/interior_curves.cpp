#include "materials/interior_curves.h"

#include <algorithm>

namespace abbe {
namespace {

class InvertedAlbedo final : public Curve {
  public:
    InvertedAlbedo(const Curve& color, double g) : color_(color), g_(g) {}
    Spectrum at(const Wavelengths& w) const override {
        return singleScatteringAlbedo(color_.at(w), static_cast<float>(g_));
    }
    double at(double nm) const override { return inverted(color_.at(nm)); }
    bool isConstant() const override { return color_.isConstant(); }
    double minimum() const override { return inverted(color_.minimum()); } // it rises with the colour
    double maximum() const override { return inverted(color_.maximum()); }

  private:
    double inverted(double c) const { return std::clamp(singleScatteringAlbedo(std::min(c, 1.0), g_), 0.0, 1.0); }
    const Curve& color_;
    double g_;
};

// 1/m from m, and a factor of that.
class Reciprocal final : public Curve {
  public:
    Reciprocal(const Curve& length, double scale) : length_(length), scale_(scale) {}
    Spectrum at(const Wavelengths& w) const override {
        return Spectrum(1.f) / max(length_.at(w) * static_cast<float>(scale_), Spectrum(static_cast<float>(kShortest)));
    }
    double at(double nm) const override { return of(length_.at(nm)); }
    bool isConstant() const override { return length_.isConstant(); }
    double minimum() const override { return of(length_.maximum()); }
    double maximum() const override { return of(length_.minimum()); }

  private:
    static constexpr double kShortest = 1e-9; // an rgb value may come to nothing between its primaries
    double of(double length) const { return 1 / std::max(length * scale_, kShortest); }
    const Curve& length_;
    double scale_;
};

} // namespace

SubsurfaceInside makeSubsurfaceInside(const Curve& color, const Curve& meanFreePath, double anisotropy, double scale) {
    return {std::make_shared<Reciprocal>(meanFreePath, scale), std::make_shared<InvertedAlbedo>(color, anisotropy),
            anisotropy};
}

} // namespace abbe
