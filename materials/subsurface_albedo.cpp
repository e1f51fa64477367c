#include "materials/subsurface_albedo.h"

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

// 1/m from m.
class Reciprocal final : public Curve {
  public:
    explicit Reciprocal(const Curve& length) : length_(length) {}
    Spectrum at(const Wavelengths& w) const override {
        return Spectrum(1.f) / max(length_.at(w), Spectrum(static_cast<float>(kShortest)));
    }
    double at(double nm) const override { return of(length_.at(nm)); }
    bool isConstant() const override { return length_.isConstant(); }
    double minimum() const override { return of(length_.maximum()); }
    double maximum() const override { return of(length_.minimum()); }

  private:
    static constexpr double kShortest = 1e-9; // an rgb value may come to nothing between its primaries
    static double of(double length) { return 1 / std::max(length, kShortest); }
    const Curve& length_;
};

} // namespace

SubsurfaceInside makeSubsurfaceInside(const Curve& color, const Curve& meanFreePath, double anisotropy) {
    return {std::make_shared<Reciprocal>(meanFreePath), std::make_shared<InvertedAlbedo>(color, anisotropy),
            anisotropy};
}

} // namespace abbe
