#include "materials/stretched_ggx.h"

#include "materials/fresnel.h"
#include "materials/ggx.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace abbe {
namespace {

// The argument at which an increasing function of [low, high] takes the value.
template <typename F> double inverse(F&& f, double value, double low, double high) {
    for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        (static_cast<double>(f(middle)) < value ? low : high) = middle;
    }
    return (low + high) / 2;
}

} // namespace

float StretchedGrid::azimuthPosition(Vec3 wo) const {
    const float x = std::abs(wo.x), y = std::abs(wo.y);
    return (std::atan2(y, x) + std::atan2(alphaY_ * y, alphaX_ * x)) * kInvPi;
}

float StretchedGrid::widthTowards(Vec3 wo) const {
    const float sine2 = wo.x * wo.x + wo.y * wo.y;
    if (!(sine2 > 0)) return alphaX_;
    return std::max(static_cast<float>(GgxAlbedoGrid::kMinAlpha),
                    std::sqrt((square(alphaX_ * wo.x) + square(alphaY_ * wo.y)) / sine2));
}

Vec3 StretchedGrid::direction(int azimuth, int mu) const {
    const auto towards = [](double phi) {
        return Vec3{static_cast<float>(std::cos(phi)), static_cast<float>(std::sin(phi)), 0};
    };
    const double phi =
        inverse([&](double x) { return azimuthPosition(towards(x)); }, azimuth / (kAzimuths - 1.0), 0, kPiD / 2);
    const Vec3 along = towards(phi);
    const auto width = static_cast<double>(widthTowards(along)), critical = static_cast<double>(criticalMu_);
    const auto position = [&](double x) { return GgxAlbedoGrid::coordinate(x, width, critical); };
    const double z = std::max(1e-5, inverse(position, mu / (kMu - 1.0), 0, 1));
    const auto sine = static_cast<float>(safeSqrt(1 - z * z));
    return {along.x * sine, along.y * sine, static_cast<float>(z)};
}

StretchedGrid::Place StretchedGrid::find(Vec3 wo) const {
    const auto cellOf = [](float position, int count, int& cell) {
        const float scaled = std::clamp(position, 0.f, 1.f) * static_cast<float>(count - 1);
        cell = std::min(static_cast<int>(scaled), count - 2);
        return scaled - static_cast<float>(cell);
    };
    Place p{};
    p.u = cellOf(azimuthPosition(wo), kAzimuths, p.azimuth);
    p.v = cellOf(GgxAlbedoGrid::coordinate(wo.z, widthTowards(wo), criticalMu_), kMu, p.mu);
    return p;
}

// E(wo) = ∫ G2/G1 over the visible normals.
StretchedAlbedo::StretchedAlbedo(float alphaX, float alphaY) : grid_(alphaX, alphaY) {
    const Ggx ggx(alphaX, alphaY);
    grid_.fill(table_, [&](Vec3 wo) {
        double sum = 0;
        forVisibleMicrofacets(ggx, wo, [&](Vec3 m, double share) {
            const Vec3 wi = reflect(wo, m);
            if (wi.z > 0) sum += share * static_cast<double>(ggx.maskingOverCosine(wo, wi) / ggx.visible(wo));
        });
        return static_cast<float>(std::min(1.0, sum));
    });
}

namespace {

// G2/G1 on either side of microfacet m, times what it reflects and what it lets through.
StretchedInterface::Shares kept(const Ggx& ggx, Vec3 wo, Vec3 m, float eta) {
    const float c = std::min(dot(wo, m), 1.f), reflected = fresnelDielectric(c, Spectrum(eta))[0];
    const auto escaping = [&](Vec3 wi) { return ggx.maskingOverCosine(wo, wi) / ggx.visible(wo); };
    StretchedInterface::Shares shares;
    if (const Vec3 wi = reflect(wo, m); wi.z > 0) shares.reflected = reflected * escaping(wi);
    const float g2 = (eta - 1) * (eta + 1) + c * c;
    if (!(g2 > 0)) return shares;
    if (const Vec3 wi = (m * (c - std::sqrt(g2)) - wo) * (1 / eta); wi.z < 0)
        shares.transmitted = (1 - reflected) * escaping(wi);
    return shares;
}

} // namespace

StretchedInterface::StretchedInterface(float alphaX, float alphaY, float eta)
    : eta_(eta), sides_{make(alphaX, alphaY, eta), make(alphaX, alphaY, 1 / eta)} {}

StretchedInterface::Side StretchedInterface::make(float alphaX, float alphaY, float eta) {
    Side side{StretchedGrid(alphaX, alphaY, eta < 1 ? std::sqrt((1 - eta) * (1 + eta)) : 0), {}};
    const Ggx ggx(alphaX, alphaY);
    side.grid.fill(side.table, [&](Vec3 wo) {
        double reflected = 0, transmitted = 0;
        forVisibleMicrofacets(ggx, wo, [&](Vec3 m, double share) {
            if (!(dot(wo, m) > 0)) return;
            const Shares s = kept(ggx, wo, m, eta);
            reflected += share * static_cast<double>(s.reflected);
            transmitted += share * static_cast<double>(s.transmitted);
        });
        return Shares{static_cast<float>(std::min(reflected, 1.0)), static_cast<float>(std::min(transmitted, 1.0))};
    });
    return side;
}

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
