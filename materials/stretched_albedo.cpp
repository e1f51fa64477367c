#include "materials/stretched_albedo.h"

#include "materials/ggx.h"
#include "materials/ggx_albedo.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

using Grid = GgxAlbedoGrid;

// E(wo) = ∫ G2/G1 over the visible normals, on a Fibonacci lattice that crowds towards the lower rim of the cap, where
// reflections begin to miss.
float integrate(const Ggx& ggx, Vec3 wo) {
    constexpr int count = 1597, step = 987; // Fibonacci numbers 17 and 16
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * step / count, 1.0);
        const double rim = (1 - t) * (1 - t);
        const Vec3 m = ggx.sampleVisible(wo, {static_cast<float>(u), static_cast<float>(1 - rim * (1 - t))});
        const Vec3 wi = reflect(wo, m);
        if (wi.z > 0) sum += 3 * rim * static_cast<double>(ggx.maskingOverCosine(wo, wi) / ggx.visible(wo));
    }
    return static_cast<float>(std::min(1.0, sum / count));
}

// The argument at which an increasing function of [low, high] takes the value.
template <typename F> double inverse(F&& f, double value, double low, double high) {
    for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        (static_cast<double>(f(middle)) < value ? low : high) = middle;
    }
    return (low + high) / 2;
}

} // namespace

StretchedAlbedo::StretchedAlbedo(float alphaX, float alphaY) : alphaX_(alphaX), alphaY_(alphaY) {
    const Ggx ggx(alphaX, alphaY);
    for (int a = 0; a < kAzimuths; ++a) {
        const auto azimuth = [](double phi) {
            return Vec3{static_cast<float>(std::cos(phi)), static_cast<float>(std::sin(phi)), 0};
        };
        const double phi =
            inverse([&](double x) { return azimuthPosition(azimuth(x)); }, a / (kAzimuths - 1.0), 0, kPiD / 2);
        const Vec3 towards = azimuth(phi);
        const auto width = static_cast<double>(widthTowards(towards));
        for (int j = 0; j < kMu; ++j) {
            const double mu = std::max(
                1e-5, inverse([&](double x) { return Grid::coordinate(x, width, 0.0); }, j / (kMu - 1.0), 0, 1));
            const auto sine = static_cast<float>(safeSqrt(1 - mu * mu));
            table_[static_cast<std::size_t>(a * kMu + j)] =
                integrate(ggx, {towards.x * sine, towards.y * sine, static_cast<float>(mu)});
        }
    }
}

float StretchedAlbedo::azimuthPosition(Vec3 wo) const {
    const float x = std::abs(wo.x), y = std::abs(wo.y);
    return (std::atan2(y, x) + std::atan2(alphaY_ * y, alphaX_ * x)) * kInvPi;
}

float StretchedAlbedo::widthTowards(Vec3 wo) const {
    const float sine2 = wo.x * wo.x + wo.y * wo.y;
    if (!(sine2 > 0)) return alphaX_;
    return std::max(static_cast<float>(Grid::kMinAlpha),
                    std::sqrt((square(alphaX_ * wo.x) + square(alphaY_ * wo.y)) / sine2));
}

float StretchedAlbedo::operator()(Vec3 wo) const {
    const auto cellOf = [](float position, int count, int& cell) {
        const float scaled = std::clamp(position, 0.f, 1.f) * static_cast<float>(count - 1);
        cell = std::min(static_cast<int>(scaled), count - 2);
        return scaled - static_cast<float>(cell);
    };
    int a, j;
    const float u = cellOf(azimuthPosition(wo), kAzimuths, a);
    const float v = cellOf(Grid::coordinate(wo.z, widthTowards(wo), 0.f), kMu, j);
    const float low = std::lerp(node(a, j), node(a, j + 1), v), high = std::lerp(node(a + 1, j), node(a + 1, j + 1), v);
    return std::lerp(low, high, u);
}

} // namespace abbe
