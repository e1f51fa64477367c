#include "media/draine.h"

#include "math/vec.h"

namespace abbe {

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

} // namespace abbe
