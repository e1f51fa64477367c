#include "materials/openpbr_veil.h"

namespace abbe {

OpenPbrVeil::OpenPbrVeil(const OpenPbrParams& p)
    : coat_(tints(p.coatColor) ? static_cast<float>(p.coatWeight.value) : 0),
      fuzz_(static_cast<float>(p.fuzzWeight.value)), color_(p.coatColor.curve),
      coatIor_(static_cast<float>(p.coatIor.value)), sheen_(static_cast<float>(p.fuzzRoughness.value)) {}

bool OpenPbrVeil::needed(const OpenPbrParams& p) {
    return p.emissionLuminance > 0 && ((p.coatWeight.value > 0 && tints(p.coatColor)) || p.fuzzWeight.value > 0);
}

Spectrum OpenPbrVeil::passing(float cosine, const Wavelengths& lambda) const noexcept {
    Spectrum share(1 - fuzz_ * sheen_.albedo(cosine));
    if (!(coat_ > 0)) return share;
    const float sine2 = (1 - cosine) * (1 + cosine) / square(coatIor_);
    const float inside = std::sqrt(std::max(1 - sine2, 1e-6f)); // as OpenPbrCover::cosineInCoat
    const Spectrum way = log(max(color_->at(lambda), Spectrum(1e-6f))) * (0.5f / inside);
    return share * fma(exp(way) - Spectrum(1.f), Spectrum(coat_), Spectrum(1.f));
}

} // namespace abbe
