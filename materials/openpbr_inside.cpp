#include "materials/interior_curves.h"
#include "materials/openpbr.h"
#include "spectrum/curve.h"

#include <algorithm>

namespace abbe {
namespace {

bool isLit(const schema::TexturedNumber& n) { return n.texture || n.value > 0; }
bool isWhole(const schema::TexturedNumber& n) { return !n.texture && n.value == 1; }

// Clear glass that also scatters [Andersson2024]: transmission-color is what is left of the light after the depth d,
// by absorption and scattering together, σt = -ln T / d, and S = transmission-scatter scatters σs = S / d. Where that
// would be more than is lost, absorption is raised by the same at all wavelengths until it is nowhere below 0.
class GlassExtinction final : public Curve {
  public:
    GlassExtinction(const Curve& color, const Curve& scatter, double depth) : lost_(color, depth) {
        double excess = 0;
        for (double nm = 360; nm <= 830; ++nm) excess = std::max(excess, scatter.at(nm) / depth - lost_.at(nm));
        raised_ = excess;
    }
    Spectrum at(const Wavelengths& w) const override { return lost_.at(w) + Spectrum(static_cast<float>(raised_)); }
    double at(double nm) const override { return lost_.at(nm) + raised_; }
    bool isConstant() const override { return lost_.isConstant(); }
    double minimum() const override { return lost_.minimum() + raised_; }
    double maximum() const override { return lost_.maximum() + raised_; }

  private:
    AttenuationCurve lost_;
    double raised_ = 0; // 1/m
};

// σs / σt.
class GlassAlbedo final : public Curve {
  public:
    GlassAlbedo(std::shared_ptr<const Curve> extinction, const Curve& scatter, double depth)
        : extinction_(std::move(extinction)), scatter_(scatter), depth_(depth) {}
    Spectrum at(const Wavelengths& w) const override {
        const Spectrum lost = extinction_->at(w) * static_cast<float>(depth_);
        return min(scatter_.at(w) / max(lost, Spectrum(1e-30f)), Spectrum(1.f));
    }
    double at(double nm) const override { return of(scatter_.at(nm), extinction_->at(nm)); }
    bool isConstant() const override { return extinction_->isConstant() && scatter_.isConstant(); }
    double minimum() const override { return of(scatter_.minimum(), extinction_->maximum()); }
    double maximum() const override { return of(scatter_.maximum(), extinction_->minimum()); }

  private:
    double of(double scatter, double extinction) const {
        return std::min(scatter / std::max(extinction * depth_, 1e-30), 1.0);
    }
    std::shared_ptr<const Curve> extinction_;
    const Curve& scatter_;
    double depth_;
};

const Curve& orElse(const Curve* curve, const ConstantCurve& byDefault) { return curve ? *curve : byDefault; }

} // namespace

bool hasSubsurfaceInside(const OpenPbrParams& p) {
    return !p.geometryThinWalled && isLit(p.subsurfaceWeight) && !isWhole(p.transmissionWeight) &&
           !isWhole(p.baseMetalness);
}

bool mayRefract(const OpenPbrParams& p) {
    return !p.geometryThinWalled && isLit(p.transmissionWeight) && !isWhole(p.baseMetalness);
}

bool hasScatteringGlass(const OpenPbrParams& p) {
    return mayRefract(p) && p.transmissionDepth > 0 && p.transmissionScatter && p.transmissionScatter->maximum() > 0;
}

std::optional<SubsurfaceInside> insideOf(const OpenPbrParams& p) {
    static const ConstantCurve white(1), light(0.8);
    if (hasSubsurfaceInside(p))
        return makeSubsurfaceInside(orElse(p.subsurfaceColor.curve, light), orElse(p.subsurfaceRadiusScale, white),
                                    p.subsurfaceScatterAnisotropy, p.subsurfaceRadius);
    if (!hasScatteringGlass(p)) return std::nullopt;
    const auto extinction = std::make_shared<GlassExtinction>(orElse(p.transmissionColor.curve, white),
                                                              *p.transmissionScatter, p.transmissionDepth);
    return SubsurfaceInside{extinction,
                            std::make_shared<GlassAlbedo>(extinction, *p.transmissionScatter, p.transmissionDepth),
                            p.transmissionScatterAnisotropy};
}

} // namespace abbe
