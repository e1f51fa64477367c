#include "media/homogeneous.h"

#include "spectrum/curve.h"

#include <algorithm>

namespace abbe {

// A curve that goes no higher than this.

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

namespace {

// A ray in one segment.
class WholeRay {
  public:
    explicit WholeRay(float tMax) : tMax_(tMax) {}
    bool next(MediumSegment& segment) noexcept {
        if (done_) return false;
        done_ = true;
        segment = {0, tMax_, 1, 1, 1};
        return true;
    }

  private:
    float tMax_;
    bool done_ = false;
};

class EvenDensity final : public MediumWalk {
  public:
    explicit EvenDensity(float tMax) : ray_(tMax) {}
    bool next(MediumSegment& segment) noexcept override { return ray_.next(segment); }
    float density(float) noexcept override { return 1; }

  private:
    WholeRay ray_;
};

class EvenGlow final : public EmissionWalk {
  public:
    EvenGlow(const Glow& glow, float kelvin, float tMax) : ray_(tMax), glow_(&glow), kelvin_(kelvin) {}
    bool next(MediumSegment& segment) noexcept override { return ray_.next(segment); }
    Spectrum emitted(float, const Wavelengths& lambda) noexcept override { return glow_->at(kelvin_, lambda); }

  private:
    WholeRay ray_;
    const Glow* glow_;
    float kelvin_;
};

} // namespace

HomogeneousMedium::HomogeneousMedium(MediumOptics optics, std::optional<Glow> glow, double kelvin)
    : OpticalMedium(std::move(optics)) {
    if (glow) emission_.emplace(*glow, static_cast<float>(kelvin));
}

void HomogeneousMedium::limitExtinction(double most) {
    replaceExtinction(std::make_shared<LimitedCurve>(extinction(), most));
}

EmissionWalk* HomogeneousMedium::Emission::walk(const Ray&, float tMax, WalkSpace& space) const noexcept {
    return tMax < kInfinity ? space.make<EvenGlow>(glow_, kelvin_, tMax) : nullptr;
}

Bounds3 HomogeneousMedium::bounds() const {
    return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
}

MediumWalk* HomogeneousMedium::walk(const Ray&, float tMax, WalkSpace& space) const noexcept {
    return space.make<EvenDensity>(tMax);
}

schema::TypeInfo homogeneousType() {
    using namespace schema;
    std::vector<FieldInfo> fields;
    addOpticsFields<HomogeneousParams>(fields);
    addGlowFields<HomogeneousParams>(fields);
    fields.push_back(
        field<HomogeneousParams, double>(FieldType::quantity, "temperature", &HomogeneousParams::temperature)
            .unit({Dimension::temperature})
            .range(0, 1e9)
            .synonyms({"blackbody", "kelvin"})
            .doc("It emits by Kirchhoff's law: what it absorbs, times a black body of this temperature.")
            .example("temperature 1900 K"));
    return {schema::Kind::medium,
            "homogeneous",
            "The same everywhere inside the shape that it fills.",
            "medium milk homogeneous { scattering 1200 per-m; absorption 0.4 per-m }",
            true,
            std::move(fields)};
}

} // namespace abbe
