#include "materials/met_cosines.h"

namespace abbe {

namespace {

// Half of the width between the inner points of a narrow lobe, in units of its spread: 0.6, and less of wide ones,
// whose own are known.
constexpr float kInnerHalf = 0.5f;

} // namespace

MetCosines::MetCosines(Spectrum lobe, float spread, float from, Kinks kinks, bool fine)
    : middle_(0.5f * (lobe[3] + lobe[4])), width_(std::max({0.5f * (lobe[5] - lobe[2]), kInnerHalf * spread, 1e-5f})) {
    std::ranges::sort(kinks);
    const auto intervals = 1 + std::ranges::count_if(kinks, [&](float k) { return k > from; });
    const int blocks = intervals == 1 ? (fine ? 4 : 2) : intervals == 2 ? 4 : 2;
    bool critical = from > 0;
    for (const float kink : kinks) {
        if (!(kink > from)) continue;
        addInterval(from, kink, critical, blocks);
        from = kink;
        critical = true;
    }
    addInterval(from, 1, critical, blocks);
}

// By the arsinh of the distance from the lobe's middle in units of its width.
void MetCosines::addInterval(float from, float to, bool critical, int blocks) {
    const float start = std::asinh((from - middle_) / width_), all = std::asinh((to - middle_) / width_) - start;
    const float panel = 1 / static_cast<float>(blocks);
    const Spectrum one(1.f);
    for (int i = 0; i < blocks; ++i, ++count_) {
        const Spectrum t = (Spectrum(kCosinePoints) + Spectrum(static_cast<float>(i))) * panel;
        const Spectrum place = critical ? t * t : t, pace = critical ? t + t : one;
        const Spectrum up = exp(fma(place, Spectrum(all), Spectrum(start))), down = one / up;
        cosines_[count_] =
            min(max(fma(up - down, Spectrum(0.5f * width_), Spectrum(middle_)), Spectrum(from)), Spectrum(to));
        steps_[count_] = (up + down) * pace * Spectrum(kCosineWeights) * (0.5f * width_ * all * panel);
    }
}

} // namespace abbe
