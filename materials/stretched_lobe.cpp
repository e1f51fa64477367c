#include "materials/stretched_lobe.h"

#include "materials/ggx.h"
#include "materials/ggx_albedo.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

using Grid = GgxAlbedoGrid;

// The argument at which an increasing function of [low, high] takes the value.
template <typename F> double inverse(F&& f, double value, double low, double high) {
    for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        (static_cast<double>(f(middle)) < value ? low : high) = middle;
    }
    return (low + high) / 2;
}

constexpr double kGauss[] = {0.0198550718, 0.1016667613, 0.2372337950, 0.4082826788,
                             0.5917173212, 0.7627662050, 0.8983332387, 0.9801449282};

} // namespace

StretchedLobe::StretchedLobe(float alphaX, float alphaY)
    : alphaX_(alphaX), alphaY_(alphaY), table_(std::make_unique<std::array<Node, kAzimuths * kMu>>()) {
    const auto azimuth = [](double phi) {
        return Vec3{static_cast<float>(std::cos(phi)), static_cast<float>(std::sin(phi)), 0};
    };
    for (int a = 0; a < kAzimuths; ++a) {
        const double phi =
            inverse([&](double x) { return azimuthPosition(azimuth(x)); }, a / (kAzimuths - 1.0), 0, kPiD / 2);
        const Vec3 towards = azimuth(phi);
        const auto width = static_cast<double>(widthTowards(towards));
        for (int j = 0; j < kMu; ++j) {
            const double mu = std::max(
                1e-5, inverse([&](double x) { return Grid::coordinate(x, width, 0.0); }, j / (kMu - 1.0), 0, 1));
            const auto sine = static_cast<float>(safeSqrt(1 - mu * mu));
            (*table_)[static_cast<std::size_t>(a * kMu + j)] =
                integrate({towards.x * sine, towards.y * sine, static_cast<float>(mu)});
        }
    }
}

// Over the visible normals, on a Fibonacci lattice that crowds towards the lower rim of the cap, where reflections
// begin to miss.
StretchedLobe::Node StretchedLobe::integrate(Vec3 wo) const {
    constexpr int count = 1597, step = 987; // Fibonacci numbers 17 and 16
    struct Event {
        float cosine, share;
    };
    const Ggx ggx(alphaX_, alphaY_);
    std::array<Event, count> events;
    std::size_t used = 0;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * step / count, 1.0), rim = (1 - t) * (1 - t);
        const Vec3 m = ggx.sampleVisible(wo, {static_cast<float>(u), static_cast<float>(1 - rim * (1 - t))});
        const Vec3 wi = reflect(wo, m);
        if (!(wi.z > 0)) continue;
        const float share = static_cast<float>(3 * rim) * ggx.maskingOverCosine(wo, wi) / ggx.visible(wo);
        events[used++] = {dot(wo, m), share};
        sum += static_cast<double>(share);
    }
    std::sort(events.begin(), events.begin() + static_cast<std::ptrdiff_t>(used),
              [](const Event& a, const Event& b) { return a.cosine < b.cosine; });
    Node node;
    node.albedo = static_cast<float>(std::min(1.0, sum / count));
    const float width = widthTowards(wo);
    double below = 0;
    float previous = used ? events[0].cosine : wo.z;
    int k = 0;
    for (std::size_t i = 0; i < used && k < kLanes; ++i) {
        const double middle = below + static_cast<double>(events[i].share) / 2;
        for (; k < kLanes && kGauss[k] * sum <= middle; ++k)
            node.offset.v[k] = (0.5f * (previous + events[i].cosine) - wo.z) / width;
        below += static_cast<double>(events[i].share);
        previous = events[i].cosine;
    }
    for (; k < kLanes; ++k) node.offset.v[k] = (previous - wo.z) / width;
    return node;
}

float StretchedLobe::azimuthPosition(Vec3 wo) const {
    const float x = std::abs(wo.x), y = std::abs(wo.y);
    return (std::atan2(y, x) + std::atan2(alphaY_ * y, alphaX_ * x)) * kInvPi;
}

float StretchedLobe::widthTowards(Vec3 wo) const {
    const float sine2 = wo.x * wo.x + wo.y * wo.y;
    if (!(sine2 > 0)) return alphaX_;
    return std::max(static_cast<float>(Grid::kMinAlpha),
                    std::sqrt((square(alphaX_ * wo.x) + square(alphaY_ * wo.y)) / sine2));
}

StretchedLobe::Place StretchedLobe::find(Vec3 wo) const {
    const auto cellOf = [](float position, int count, int& cell) {
        const float scaled = std::clamp(position, 0.f, 1.f) * static_cast<float>(count - 1);
        cell = std::min(static_cast<int>(scaled), count - 2);
        return scaled - static_cast<float>(cell);
    };
    Place p{};
    p.u = cellOf(azimuthPosition(wo), kAzimuths, p.azimuth);
    p.v = cellOf(Grid::coordinate(wo.z, widthTowards(wo), 0.f), kMu, p.mu);
    return p;
}

float StretchedLobe::mirrorAlbedo(Vec3 wo) const {
    const Place p = find(wo);
    const int a = p.azimuth, j = p.mu;
    const float low = std::lerp(node(a, j).albedo, node(a, j + 1).albedo, p.v);
    const float high = std::lerp(node(a + 1, j).albedo, node(a + 1, j + 1).albedo, p.v);
    return std::lerp(low, high, p.u);
}

Spectrum StretchedLobe::cosines(Vec3 wo) const {
    const Place p = find(wo);
    const int a = p.azimuth, j = p.mu;
    const auto between = [](Spectrum x, Spectrum y, float t) { return fma(y - x, Spectrum(t), x); };
    const Spectrum offset = between(between(node(a, j).offset, node(a, j + 1).offset, p.v),
                                    between(node(a + 1, j).offset, node(a + 1, j + 1).offset, p.v), p.u);
    return min(max(fma(offset, Spectrum(widthTowards(wo)), Spectrum(wo.z)), Spectrum(0.f)), Spectrum(1.f));
}

} // namespace abbe
