#include "media/henyey_greenstein.h"

#include "math/vec.h"

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

} // namespace abbe
