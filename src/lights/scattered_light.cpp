#include "lights/scattered_light.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace abbe {

namespace {

constexpr double kSkyDegree = kPiD / 180;
// Light reaches a place from where the sun stands up to so much higher or lower. Near the horizon its light changes
// fast.
constexpr double kSunSpan = 10 * kSkyDegree, kLowSun = 88 * kSkyDegree;
constexpr double kCoarseStep = 2.5 * kSkyDegree, kFineStep = 1 * kSkyDegree;
constexpr int kMaxIterations = 24;
constexpr double kConverged = 1e-3; // relative change of an iteration

// Directions: Gauss–Legendre in the cosine over each hemisphere, even in azimuth over one half of the circle.
struct CosineNode {
    double cosine, weight;
};
constexpr CosineNode kCosines[] = {{0.0694318442, 0.1739274226},  {0.3300094782, 0.3260725774},
                                   {0.6699905218, 0.3260725774},  {0.9305681558, 0.1739274226},
                                   {-0.0694318442, 0.1739274226}, {-0.3300094782, 0.3260725774},
                                   {-0.6699905218, 0.3260725774}, {-0.9305681558, 0.1739274226}};
constexpr int kAzimuths = 4;

// ∫ e^-σt dt over a length: (1 - e^-σl) / σ, by its series where the difference would lose its digits.
Spectrum lengthSeen(Spectrum extinction, float length) {
    const Spectrum depth = extinction * length;
    const Spectrum series = fma(depth, fma(depth, Spectrum(1 / 6.f), Spectrum(-0.5f)), Spectrum(1.f)) * length;
    return select(depth.v < 0.02f, series, (Spectrum(1.f) - exp(-depth)) / max(extinction, Spectrum(1e-30f)));
}

} // namespace

SkyBands lengthSeen(const SkyBands& extinction, double length) {
    return {lengthSeen(extinction.low, static_cast<float>(length)),
            lengthSeen(extinction.high, static_cast<float>(length))};
}

std::array<float, ScatteredLight::kMoments> ScatteredLight::basis(float x, float z) {
    constexpr float root3 = 1.7320508f;
    const float y2 = std::max(0.f, 1 - x * x - z * z);
    return {1, z, x, 1.5f * z * z - 0.5f, root3 * x * z, 0.5f * root3 * (x * x - y2)};
}

struct ScatteredLight::Place {
    int angle;
    float fraction;
};

ScatteredLight::Place ScatteredLight::place(double sunZenith) const {
    const double x = std::clamp((sunZenith - first_) / step_, 0.0, angles_ - 1.0);
    const int i = std::min(static_cast<int>(x), angles_ - 2);
    return {i, static_cast<float>(x - i)};
}

// What lies along a ray in a direction that makes one angle with the vertical, whatever its azimuth.
struct ScatteredLight::Way {
    struct Part {
        int shell;
        float t, r, z; // of its middle: the distance, the radius, the ray's direction against the vertical there
        SkyBands seen; // length, less what is taken on the way here
    };
    std::vector<Part> parts;
    double r = 0; // where it starts
    bool ground = false;
    float groundDistance = 0;
    SkyBands groundSeen; // share that arrives from the ground

    void trace(const ClearAir& air, int level, double cosine) {
        parts.clear();
        r = air.radius(level);
        SkyBands passed(1);
        double end = 0;
        const auto add = [&](int shell, double t0, double t1) {
            const SkyBands& extinction = air.at(shell).extinction;
            const double t = (t0 + t1) / 2, there = std::sqrt(r * r + t * t + 2 * r * t * cosine);
            parts.push_back({shell, static_cast<float>(t), static_cast<float>(there),
                             static_cast<float>((r * cosine + t) / there), passed * lengthSeen(extinction, t1 - t0)});
            passed = passed * exp(extinction * static_cast<float>(t0 - t1));
            end = t1;
        };
        // On the ground a ray that goes down has come to its end.
        ground = cosine < 0 && level == 0 ? true : air.walk(r, cosine < 0 ? level - 1 : level, cosine, add);
        groundDistance = static_cast<float>(end);
        groundSeen = passed;
    }
};

ScatteredLight::ScatteredLight(const ClearAir& air, double sunZenith, const SkyBands& groundAlbedo)
    : first_(std::max(0.0, sunZenith - kSunSpan)), step_(sunZenith > kLowSun ? kFineStep : kCoarseStep),
      angles_(static_cast<int>(std::ceil((sunZenith + kSunSpan - first_) / step_)) + 1),
      field_(static_cast<std::size_t>(kLevels * angles_)), direct_(field_.size()), sources_(field_.size()) {
    for (int shell = 0; shell < ClearAir::kShells; ++shell)
        for (int i = 0; i < angles_; ++i) {
            const double r = (air.radius(shell) + air.radius(shell + 1)) / 2, c = std::cos(angle(i));
            const SkyBands light = air.sunlight(r, shell, c);
            const auto b = basis(static_cast<float>(std::sin(angle(i))), static_cast<float>(c));
            for (std::size_t k = 0; k < kMoments; ++k) direct_[index(shell, i)][k] = light * b[k];
        }
    for (int i = 0; i < angles_; ++i) {
        const double c = std::cos(angle(i));
        sunlit_.push_back(air.sunlight(ClearAir::kGroundRadius, 0, c) * static_cast<float>(std::max(c, 0.0)));
        ground_.push_back(SkyBands(0));
    }
    for (Moments& m : field_) m.fill(SkyBands(0));
    const auto findSources = [&] {
        for (int shell = 0; shell < ClearAir::kShells; ++shell) findSource(air, shell);
    };
    findSources();
    for (double change = 1; change > kConverged && iterations_ < kMaxIterations; ++iterations_) {
        const std::vector<Moments> before(field_.begin(), field_.begin() + angles_);
        // Down and up in turn; each level at once lights the next: half the iterations.
        for (int i = 0; i < kLevels; ++i) gather(air, iterations_ % 2 == 0 ? kLevels - 1 - i : i, groundAlbedo);
        change = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const SkyBands now = field_[i][0], ratio = (now - before[i][0]) / (now + SkyBands(1e-30f));
            change = std::max({change, double(maxLane(abs(ratio.low))), double(maxLane(abs(ratio.high)))});
        }
    }
    for (Moments& m : direct_) m.fill(SkyBands(0)); // what is scattered for the first time is not meant by source()
    findSources();
}

void ScatteredLight::findSource(const ClearAir& air, int shell) {
    for (int i = 0; i < angles_; ++i)
        for (std::size_t k = 0; k < kMoments; ++k) {
            const std::size_t l = kDegree[k];
            const SkyBands light =
                direct_[index(shell, i)][k] + (field_[index(shell, i)][k] + field_[index(shell + 1, i)][k]) * 0.5f;
            sources_[index(shell, i)][k] = air.at(shell).scatterings[l] * light *
                                           static_cast<float>((2 * static_cast<double>(l) + 1) / (4 * kPiD));
        }
}

void ScatteredLight::gather(const ClearAir& air, int level, const SkyBands& groundAlbedo) {
    Moments none;
    none.fill(SkyBands(0));
    std::vector<Moments> field(static_cast<std::size_t>(angles_), none);
    std::vector<SkyBands> ground(field.size(), SkyBands(0));
    Way way;
    for (const auto& [cosine, weight] : kCosines) {
        way.trace(air, level, cosine);
        const double solidAngle = 2 * kPiD / kAzimuths * weight;
        for (int a = 0; a < kAzimuths; ++a) {
            const double x = std::sqrt(1 - cosine * cosine) * std::cos((a + 0.5) / kAzimuths * kPiD);
            const auto b = basis(static_cast<float>(x), static_cast<float>(cosine));
            for (std::size_t i = 0; i < field.size(); ++i) {
                const SkyBands light =
                    radiance(way, x, cosine, static_cast<int>(i), groundAlbedo) * static_cast<float>(solidAngle);
                for (std::size_t k = 0; k < kMoments; ++k) field[i][k] = fma(light, b[k], field[i][k]);
                if (cosine > 0) ground[i] += light * static_cast<float>(cosine);
            }
        }
    }
    std::copy(field.begin(), field.end(), field_.begin() + static_cast<std::ptrdiff_t>(index(level, 0)));
    if (level == 0) ground_ = std::move(ground);
    if (level > 0) findSource(air, level - 1);
    if (level < ClearAir::kShells) findSource(air, level);
}

// Along the way the zenith turns, and the sun's angle from it with it.
SkyBands ScatteredLight::radiance(const Way& way, double x, double z, int angle, const SkyBands& groundAlbedo) const {
    const float cosSun = static_cast<float>(std::cos(this->angle(angle)));
    const float sinSun = static_cast<float>(std::sin(this->angle(angle)));
    const float fromSun = static_cast<float>(x) * sinSun + static_cast<float>(z) * cosSun; // cosine
    const auto sunCosine = [&](float t, float r) {
        return std::clamp((static_cast<float>(way.r) * cosSun + t * fromSun) / r, -1.f, 1.f);
    };
    SkyBands total(0);
    for (const Way::Part& part : way.parts) {
        const float c = sunCosine(part.t, part.r), s = safeSqrt(1 - c * c);
        const auto b = basis((fromSun - part.z * c) / std::max(s, 1e-4f), part.z);
        const Place at = place(static_cast<double>(std::acos(c)));
        const Moments& m0 = sources_[index(part.shell, at.angle)];
        const Moments& m1 = sources_[index(part.shell, at.angle + 1)];
        SkyBands j0(0), j1(0);
        for (std::size_t k = 0; k < kMoments; ++k) {
            j0 = fma(m0[k], b[k], j0);
            j1 = fma(m1[k], b[k], j1);
        }
        total = fma(part.seen, fma(j1 - j0, at.fraction, j0), total);
    }
    if (!way.ground) return total;
    const Place at = place(static_cast<double>(std::acos(sunCosine(way.groundDistance, ClearAir::kGroundRadius))));
    const auto lit = [&](int i) { return sunlit_[static_cast<std::size_t>(i)] + ground_[static_cast<std::size_t>(i)]; };
    const SkyBands irradiance = fma(lit(at.angle + 1) - lit(at.angle), at.fraction, lit(at.angle));
    return fma(groundAlbedo * way.groundSeen * kInvPi, irradiance, total);
}

ScatteredLight::Moments ScatteredLight::source(int shell, double sunZenith) const {
    const Place at = place(sunZenith);
    Moments result;
    for (std::size_t k = 0; k < kMoments; ++k) {
        const auto light = [&](int i) { return sources_[index(shell, i)][k]; };
        result[k] = fma(light(at.angle + 1) - light(at.angle), at.fraction, light(at.angle));
    }
    return result;
}

} // namespace abbe
