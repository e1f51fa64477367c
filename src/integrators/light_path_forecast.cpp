#include "integrators/light_path_forecast.h"

#include <algorithm>
#include <cmath>

namespace abbe {

LightPathForecast::LightPathForecast(std::span<const LightDeposit> deposits, PixelBounds frame,
                                     const NoiseMeasure& measure) {
    const auto pixels = static_cast<double>(frame.area());
    terms_.reserve(deposits.size());
    for (const LightDeposit& d : deposits) {
        const double rho = std::max(d.rho, 1e-12); // no camera path may find it
        const double u = d.luminance * std::sqrt(measure.weight(d.x, d.y));
        terms_.push_back({u * u * d.stands / pixels, rho, u / rho});
    }
    limitOutliers();
    std::ranges::stable_sort(terms_, std::ranges::greater(), &Term::spark);
}

// A few deposits that camera paths would meet once in millions would say all of a second moment, and next to nothing of
// what renders show: the largest count as the ninth.
void LightPathForecast::limitOutliers() {
    constexpr std::size_t kFew = 8;
    if (terms_.size() <= kFew) return;
    const auto largest = [](const Term& a, const Term& b) { return a.ofCamera(0) > b.ofCamera(0); };
    const auto ninth = terms_.begin() + kFew;
    std::ranges::nth_element(terms_, ninth, largest);
    const double most = ninth->ofCamera(0);
    for (auto t = terms_.begin(); t != ninth; ++t) {
        t->spark *= most * t->rho / t->u2;
        t->rho = t->u2 / most;
    }
}

double LightPathForecast::sparks() const {
    constexpr double kSpark = 3; // light that is asked for varies by less
    double sum = 0;
    for (const Term& t : terms_)
        if (t.spark > kSpark) sum += t.ofCamera(0);
    return sum;
}

// The second moment that light paths tell and a look at some pixels has not seen is that of the brightest sparks, which
// are the rarest; a mean of samples has all of it, stratified or not. The rest is as noisy as it was seen to be, which
// is less than its second moment: most of it may be light that camera paths find with next to no noise.
double LightPathForecast::variance(double share, const CameraVariance& alone) const {
    double foretold = 0;
    for (const Term& t : terms_) foretold += t.ofCamera(0);
    double missed = std::max(0.0, foretold - alone.secondMoment);
    double variance = 0, seenAlone = 0, seen = 0;
    for (const Term& t : terms_) {
        if (missed > 0)
            variance += t.ofCamera(share);
        else {
            seenAlone += t.ofCamera(0);
            seen += t.ofCamera(share);
        }
        missed -= t.ofCamera(0);
        variance += t.ofLight(share);
    }
    return variance + (seenAlone > 0 ? alone.planned() * seen / seenAlone : 0);
}

} // namespace abbe
