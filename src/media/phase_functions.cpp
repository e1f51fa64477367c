#include "media/phase_functions.h"

#include "base/check.h"
#include "math/vec.h"

#include <algorithm>

namespace abbe {

float HenyeyGreenstein::value(float cosine) const noexcept {
    // 1 + g² - 2 g cos as a sum of positive terms, which keeps its digits when both are near 1.
    const float a = std::abs(g_), c = g_ < 0 ? -cosine : cosine;
    const float d = square(1 - a) + 2 * a * (1 - c);
    return 0.25f * kInvPi * (1 - a) * (1 + a) / (d * std::sqrt(d));
}

float HenyeyGreenstein::sampleCosine(float u) const noexcept {
    if (std::abs(g_) < 1e-3f) {
        // To first order in g, where the closed form is 0/0: cdf (1 + c)/2 - 3g (1 - c²)/4; the error is below g².
        const float c = 1 - 2 * u;
        return std::clamp(c + 1.5f * g_ * (1 - c * c), -1.f, 1.f);
    }
    // The inverse of the cdf with 1 - cos factored out, for forward and backward lobes alike [Pharr2023, eq. 11.27].
    const float a = std::abs(g_);
    const float x = 1 - u; // density rises towards cos = 1
    const float s = (1 - a) * (1 + a) / (1 - a + 2 * a * x);
    const float c = 1 + (square(1 - a) - s * s) / (2 * a);
    return std::clamp(g_ < 0 ? -c : c, -1.f, 1.f);
}

// Below this the closed form loses its digits to 1/g³, and g itself means nothing.
static constexpr double kNoAsymmetry = 1e-3;

Draine::Draine(double g, double alpha) : g_(std::abs(g) < kNoAsymmetry ? 0 : g), alpha_(alpha) {
    norm_ = 0.5 * (1 - g_ * g_) / (1 + alpha_ * (1 + 2 * g_ * g_) / 3);
    if (g_ != 0) lower_ = primitive(-1);
}

// ∫ (1 + α c²) (1 + g² - 2 g c)^(-3/2) dc with s² = 1 + g² - 2 g c.
double Draine::primitive(double c) const {
    const double a = 1 + g_ * g_, s = std::sqrt(a - 2 * g_ * c), q = alpha_ / (4 * g_ * g_);
    return ((1 + q * a * a) / s + 2 * q * a * s - q * s * s * s / 3) / g_;
}

double Draine::cdf(double c) const {
    if (g_ == 0) return norm_ * (c + 1 + alpha_ * (c * c * c + 1) / 3);
    return norm_ * (primitive(c) - lower_);
}

float Draine::value(float cosine) const noexcept {
    const double c = static_cast<double>(cosine), a = std::abs(g_);
    const double d = square(1 - a) + 2 * a * (1 - (g_ < 0 ? -c : c));
    return static_cast<float>(0.5 / kPiD * norm_ * (1 + alpha_ * c * c) / (d * std::sqrt(d)));
}

// Newton's method kept inside a shrinking bracket: the cdf rises, so the answer is never lost.
float Draine::sampleCosine(float u) const noexcept {
    const double target = static_cast<double>(u);
    double low = -1, high = 1, c = 2 * target - 1;
    for (int i = 0; i < 60; ++i) {
        const double error = cdf(c) - target;
        (error > 0 ? high : low) = c;
        if (std::abs(error) < 1e-9) break;
        const double slope = 2 * kPiD * static_cast<double>(value(static_cast<float>(c)));
        c -= error / slope;
        if (!(c > low && c < high)) c = 0.5 * (low + high);
    }
    return static_cast<float>(std::clamp(c, -1.0, 1.0));
}

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
