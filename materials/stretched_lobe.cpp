#include "materials/stretched_lobe.h"

#include <algorithm>
#include <vector>

namespace abbe {
namespace {

constexpr double kGauss[] = {0.0198550718, 0.1016667613, 0.2372337950, 0.4082826788,
                             0.5917173212, 0.7627662050, 0.8983332387, 0.9801449282};

struct Event {
    float cosine;
    double share;
};

// The cosines below which the Gauss points' shares of all events lie; `none` without events.
Spectrum quantiles(std::vector<Event>& events, float none) {
    std::ranges::sort(events, {}, &Event::cosine);
    double sum = 0, below = 0;
    for (const Event& event : events) sum += event.share;
    Spectrum result(0.f);
    float previous = events.empty() ? none : events[0].cosine;
    int k = 0;
    for (const Event& event : events) {
        const double middle = below + event.share / 2;
        for (; k < kLanes && kGauss[k] * sum <= middle; ++k) result.v[k] = 0.5f * (previous + event.cosine);
        below += event.share;
        previous = event.cosine;
    }
    for (; k < kLanes; ++k) result.v[k] = previous;
    return result;
}

} // namespace

StretchedLobe::StretchedLobe(float alphaX, float alphaY)
    : grid_(alphaX, alphaY), table_(std::make_unique<StretchedGrid::Table<Node>>()) {
    const Ggx ggx(alphaX, alphaY);
    grid_.fill(*table_, [&](Vec3 wo) { return integrate(ggx, wo); });
}

StretchedLobe::Node StretchedLobe::integrate(const Ggx& ggx, Vec3 wo) const {
    std::vector<Event> reflected;
    double sum = 0;
    forVisibleMicrofacets(ggx, wo, [&](Vec3 m, double share) {
        const float c = dot(wo, m);
        const Vec3 wi = reflect(wo, m);
        if (!(wi.z > 0)) return;
        reflected.push_back({c, share * static_cast<double>(ggx.maskingOverCosine(wo, wi) / ggx.visible(wo))});
        sum += reflected.back().share;
    });
    const Spectrum mu(wo.z), scale(1 / grid_.widthTowards(wo));
    return {(quantiles(reflected, wo.z) - mu) * scale, static_cast<float>(std::min(1.0, sum))};
}

float StretchedLobe::mirrorAlbedo(Vec3 wo) const {
    return grid_.at(*table_, wo, [](const Node& node) { return node.albedo; });
}

Spectrum StretchedLobe::cosines(Vec3 wo) const {
    return placed(wo, grid_.at(*table_, wo, [](const Node& node) { return node.reflected; }));
}

Spectrum StretchedLobe::placed(Vec3 wo, Spectrum offset) const {
    return min(max(fma(offset, Spectrum(grid_.widthTowards(wo)), Spectrum(wo.z)), Spectrum(0.f)), Spectrum(1.f));
}

} // namespace abbe
