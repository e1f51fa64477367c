#include "media/mixed_phase.h"

#include "base/check.h"

#include <algorithm>

namespace abbe {

MixedPhase::MixedPhase(std::vector<Part> parts) {
    double total = 0, below = 0;
    for (const Part& part : parts) total += part.weight;
    ABBE_CHECK(total > 0);
    for (Part& part : parts) {
        if (!(part.weight > 0)) continue;
        const double weight = part.weight / total;
        spectral_ |= part.phase->spectral();
        lobes_.push_back({std::move(part.phase), static_cast<float>(weight), below});
        below += weight;
    }
}

float MixedPhase::value(float cosine) const noexcept {
    float sum = 0;
    for (const Lobe& lobe : lobes_) sum += lobe.weight * lobe.phase->value(cosine);
    return sum;
}

// The number chooses a part, and what it is within that part's share is as even as itself.
float MixedPhase::sampleCosine(float u) const noexcept {
    constexpr float kLargest = 1 - 0x1p-24f;
    std::size_t i = lobes_.size() - 1;
    while (i > 0 && static_cast<double>(u) < lobes_[i].below) --i;
    const double within = (static_cast<double>(u) - lobes_[i].below) / static_cast<double>(lobes_[i].weight);
    return lobes_[i].phase->sampleCosine(std::clamp(static_cast<float>(within), 0.f, kLargest));
}

Spectrum MixedPhase::ratio(float cosine, const Wavelengths& lambda) const noexcept {
    Spectrum sum(0.f);
    float whole = 0;
    for (const Lobe& lobe : lobes_) {
        const float value = lobe.weight * lobe.phase->value(cosine);
        if (!(value > 0)) continue;
        whole += value;
        sum += lobe.phase->spectral() ? value * lobe.phase->ratio(cosine, lambda) : Spectrum(value);
    }
    return whole > 0 ? sum / whole : Spectrum(1.f);
}

} // namespace abbe
