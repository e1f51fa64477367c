#include "media/medium_optics.h"

#include "media/phase_functions.h"

namespace abbe {

namespace {

class SumCurve final : public Curve {
  public:
    SumCurve(const Curve& a, const Curve& b) : a_(a), b_(b) {}
    Spectrum at(const Wavelengths& w) const override { return a_.at(w) + b_.at(w); }
    double at(double nm) const override { return a_.at(nm) + b_.at(nm); }
    bool isConstant() const override { return a_.isConstant() && b_.isConstant(); }
    double minimum() const override { return a_.minimum() + b_.minimum(); }
    double maximum() const override { return a_.maximum() + b_.maximum(); }

  private:
    const Curve &a_, &b_;
};

// part / whole, 0 where the whole is 0. Requires 0 <= part <= whole.
class ShareCurve final : public Curve {
  public:
    ShareCurve(const Curve& part, const Curve& whole) : part_(part), whole_(whole) {}
    Spectrum at(const Wavelengths& w) const override {
        const Spectrum whole = whole_.at(w);
        return select(whole.v > 0, part_.at(w) / whole, Spectrum(0.f));
    }
    double at(double nm) const override {
        const double whole = whole_.at(nm);
        return whole > 0 ? part_.at(nm) / whole : 0;
    }
    bool isConstant() const override { return part_.isConstant() && whole_.isConstant(); }
    double minimum() const override { return 0; }
    double maximum() const override { return 1; }

  private:
    const Curve &part_, &whole_;
};

} // namespace

std::string_view findContradiction(const MediumParams& p) {
    if (p.albedo && (p.scattering || p.absorption)) return "`albedo` goes with `extinction`";
    if (p.extinction && p.absorption) return "`absorption` goes with `scattering`";
    return {};
}

MediumOptics makeOptics(const MediumParams& params, std::shared_ptr<const PhaseFunction> phase, const Curve* zero,
                        const Curve* one) {
    MediumOptics optics;
    optics.phase = phase ? std::move(phase) : std::make_shared<HenyeyGreenstein>(0);
    optics.extinction = params.extinction ? params.extinction : one;
    optics.albedo = params.albedo ? params.albedo : one;
    if (params.extinction || !(params.scattering || params.absorption)) return optics;
    const auto keep = [&optics](auto curve) { return optics.own.emplace_back(std::move(curve)).get(); };
    if (!params.absorption) {
        optics.extinction = params.scattering;
    } else if (!params.scattering) {
        optics.extinction = params.absorption;
        optics.albedo = zero;
    } else {
        optics.extinction = keep(std::make_shared<SumCurve>(*params.scattering, *params.absorption));
        optics.albedo = keep(std::make_shared<ShareCurve>(*params.scattering, *optics.extinction));
    }
    return optics;
}

} // namespace abbe
