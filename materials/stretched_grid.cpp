#include "materials/stretched_grid.h"

#include "materials/ggx_albedo.h"

#include <algorithm>
#include <cmath>

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

} // namespace abbe
