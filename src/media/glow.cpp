#include "media/glow.h"

#include "spectrum/emission_curves.h"
#include "spectrum/sensor.h"

#include <algorithm>

namespace abbe {

Spectrum Glow::at(float kelvin, const Wavelengths& lambda) const noexcept {
    if (spectrum_) return spectrum_->at(lambda);
    if (albedo_) return at(kelvin, lambda, Spectrum(1.f));
    return extinction_->at(lambda) * planckRadiance(lambda, kelvin);
}

Spectrum Glow::at(float kelvin, const Wavelengths& lambda, const Spectrum& tint) const noexcept {
    const Spectrum absorbed = max(Spectrum(1.f) - albedo_->at(lambda) * tint, Spectrum(0.f));
    return extinction_->at(lambda) * absorbed * planckRadiance(lambda, kelvin);
}

Glow::Totals Glow::totals(double kelvin) const {
    if (thermal() && !(kelvin > static_cast<double>(kColdest))) return {};
    constexpr double kGlowStep = 5; // nm
    Totals sum;
    for (double nm = static_cast<double>(kMinWavelength); nm <= static_cast<double>(kMaxWavelength); nm += kGlowStep) {
        double value = 0;
        if (spectrum_)
            value = spectrum_->at(nm);
        else
            value =
                extinction_->at(nm) * (albedo_ ? std::max(1 - albedo_->at(nm), 0.0) : 1) * planckRadiance(nm, kelvin);
        const Wavelengths w = Wavelengths::single(static_cast<float>(nm));
        sum.watts += value * kGlowStep;
        sum.seen += value * kGlowStep * static_cast<double>(xbar(w)[0] + ybar(w)[0] + zbar(w)[0]);
    }
    return sum;
}

GlowTable::GlowTable(const Glow& glow, double hottest) {
    constexpr int kSize = 512;
    const double coldest = static_cast<double>(kColdest);
    const int size = glow.thermal() && hottest > coldest ? kSize : 1;
    for (int i = 0; i < size; ++i) {
        const Glow::Totals t = glow.totals(size > 1 ? coldest + (hottest - coldest) * i / (size - 1) : coldest);
        seen_.push_back(static_cast<float>(t.seen));
        watts_.push_back(static_cast<float>(t.watts));
    }
    if (size > 1) perKelvin_ = static_cast<float>((size - 1) / (hottest - coldest));
}

float GlowTable::lookup(const std::vector<float>& table, float kelvin) const noexcept {
    if (table.size() == 1) return table[0];
    const float last = static_cast<float>(table.size() - 1);
    const float x = std::clamp((kelvin - kColdest) * perKelvin_, 0.f, last);
    const auto cell = static_cast<std::size_t>(std::min(x, last - 1));
    const float f = x - static_cast<float>(cell);
    return table[cell] + (table[cell + 1] - table[cell]) * f;
}

std::string_view findContradiction(const GlowParams& p, const MediumOptics& optics, bool temperature, bool color) {
    if (p.emission && (temperature || p.emissivity)) return "`emission` stands alone: it is no factor of a temperature";
    if (p.emissivity && !temperature) return "`emissivity` goes with `temperature`";
    const bool absorbs = optics.extinction->maximum() > 0 && (optics.albedo->minimum() < 1 || color);
    if (temperature && !p.emissivity && !absorbs)
        return "a hot medium emits as much as it absorbs, and this one absorbs nothing: give it an `albedo` below 1, "
               "`absorption`, or an `emissivity`";
    return {};
}

std::optional<Glow> makeGlow(const GlowParams& p, const MediumOptics& optics, bool temperature) {
    if (p.emission) return Glow::ofSpectrum(*p.emission);
    if (!temperature) return std::nullopt;
    if (p.emissivity) return Glow::ofTemperature(*p.emissivity);
    return Glow::ofTemperature(*optics.extinction, *optics.albedo);
}

} // namespace abbe
