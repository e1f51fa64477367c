#include "lights/clear_sky.h"

#include "lights/scattered_light.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {
constexpr double kScalePower = 2.5; // between that of aerosol, 1.3, and of molecules, 4
constexpr int kPartsOfShell = 3;
} // namespace

double ClearSky::scale(double nm) { return std::pow(550 / nm, kScalePower); }

ClearSky::ClearSky(const AirParams& params, double sunElevation, const SkyBands& groundAlbedo)
    : sun_(std::cos(sunElevation), 0, std::sin(sunElevation)) {
    const ClearAir air(params);
    const ScatteredLight scattered(air, kPiD / 2 - sunElevation, groundAlbedo);
    const SkyBands unscaled = SkyBands::of([](double nm) { return 1 / scale(nm); });
    nodes_.reserve(static_cast<std::size_t>((kRows + 1) * (kColumns + 1)));
    for (int row = 0; row <= kRows; ++row)
        for (int column = 0; column <= kColumns; ++column) {
            Node n = look(air, scattered, square(row / double(kRows)) * kPiD / 2, column * kPiD / kColumns);
            nodes_.push_back({n.smooth * unscaled, n.haze * unscaled});
        }
}

ClearSky::Node ClearSky::look(const ClearAir& air, const ScatteredLight& scattered, double elevation,
                              double azimuth) const {
    const double z = std::sin(elevation), x = std::cos(elevation) * std::cos(azimuth);
    const double fromSun = x * sun_.x + z * sun_.z, r = ClearAir::kGroundRadius; // cosine
    const float rayleigh = rayleighPhase(static_cast<float>(fromSun));
    Node result{SkyBands(0), SkyBands(0)};
    SkyBands passed(1);
    air.walk(r, 0, z, [&](int shell, double start, double end) {
        const ClearAir::Coefficients& c = air.at(shell);
        const double length = (end - start) / kPartsOfShell;
        const SkyBands seenEach = lengthSeen(c.extinction, length),
                       passedEach = exp(c.extinction * static_cast<float>(-length));
        for (int i = 0; i < kPartsOfShell; ++i) {
            const double t = start + (i + 0.5) * length, there = std::sqrt(r * r + t * t + 2 * r * t * z);
            const double sunCosine = std::clamp((r * sun_.z + t * fromSun) / there, -1.0, 1.0);
            const double up = (r * z + t) / there, sine = std::max(safeSqrt(1 - square(sunCosine)), 1e-6);
            const SkyBands seen = passed * seenEach, sunlight = air.sunlight(there, shell, sunCosine);
            const auto b =
                ScatteredLight::basis(static_cast<float>((fromSun - up * sunCosine) / sine), static_cast<float>(up));
            const auto source = scattered.source(shell, std::acos(sunCosine));
            SkyBands more = c.rayleigh * sunlight * rayleigh;
            for (std::size_t k = 0; k < source.size(); ++k) more = fma(source[k], b[k], more);
            result.smooth = fma(seen, more, result.smooth);
            result.haze = fma(seen, c.aerosol * sunlight, result.haze);
            passed = passed * passedEach;
        }
    });
    return result;
}

SkyBands ClearSky::at(Vec3 w) const noexcept {
    const float fromSun = w.x * static_cast<float>(sun_.x) + w.z * static_cast<float>(sun_.z);
    const float row = std::sqrt(std::asin(std::clamp(w.z, 0.f, 1.f)) * (2 * kInvPi)) * kRows;
    const float column = std::atan2(std::abs(w.y), w.x) * (kInvPi * kColumns);
    const int i = std::min(static_cast<int>(row), kRows - 1), j = std::min(static_cast<int>(column), kColumns - 1);
    const float v = row - static_cast<float>(i), u = column - static_cast<float>(j);
    const Node &n00 = node(i, j), &n01 = node(i, j + 1), &n10 = node(i + 1, j), &n11 = node(i + 1, j + 1);
    const float haze = aerosolPhase(fromSun);
    const auto value = [haze](const Node& n, float weight, const SkyBands& sum) {
        return fma(fma(n.haze, haze, n.smooth), weight, sum);
    };
    return value(n00, (1 - v) * (1 - u),
                 value(n01, (1 - v) * u, value(n10, v * (1 - u), value(n11, v * u, SkyBands(0)))));
}

} // namespace abbe
