#include "volumes/noise_field.h"

#include "volumes/noise.h"

#include <array>

namespace abbe {

namespace {

// Further away double has no digits left for a place within a cell.
constexpr double kFarthest = 0x1p50;
// Places at which the distribution of the noise is measured, and the cube from which they are taken, in `scale`.
constexpr std::size_t kPlaces = 16384;
constexpr double kPlacesWithin = 4096;
// Where density is 1 at a softness of 1: in a two-thousandth of space.
constexpr double kThickest = 0.9995;

Vec3d unitVector(std::uint32_t h) {
    return {static_cast<double>(unitFloat(mix32(h ^ 0x68bc21ebu))),
            static_cast<double>(unitFloat(mix32(h ^ 0x02e5be93u))),
            static_cast<double>(unitFloat(mix32(h ^ 0x967a889bu)))};
}

std::uint32_t octaveSeed(std::uint32_t seed, int octave) {
    return mix32(seed + static_cast<std::uint32_t>(octave) * 0x9e3779b9u);
}

} // namespace

NoiseField::NoiseField(const NoisePattern& pattern)
    : pattern_(pattern), minimum_(1 - static_cast<float>(pattern.contrast)) {
    if (constant()) return;
    std::array<float, kPlaces> values;
    for (std::size_t i = 0; i < kPlaces; ++i) {
        const Vec3d place = unitVector(mix32(static_cast<std::uint32_t>(i))) * (kPlacesWithin * pattern_.scale);
        values[i] = noise(warped(place));
    }
    std::sort(values.begin(), values.end());
    const auto quantile = [&](double share) { return values[static_cast<std::size_t>(share * (kPlaces - 1))]; };
    threshold_ = quantile(1 - pattern_.coverage);
    ramp_ = std::max(1e-6f, static_cast<float>(pattern_.softness) * (quantile(kThickest) - threshold_));
    double shares = 0;
    for (const float v : values) shares += static_cast<double>(shaped(v));
    mean_ = std::clamp(static_cast<float>(shares / kPlaces), std::max(minimum_, 1e-3f), 1.f);
}

float NoiseField::shaped(float noise) const noexcept {
    const float t = std::clamp((noise - threshold_) / ramp_, 0.f, 1.f);
    return std::fma(1 - minimum_, t * t * (3 - 2 * t), minimum_);
}

float NoiseField::at(Vec3d p) const noexcept {
    if (constant()) return 1;
    return std::clamp(shaped(noise(warped(p))), minimum_, 1.f);
}

// Octaves are shifted against each other, so that their lattices do not coincide.
float NoiseField::noise(Vec3d p) const noexcept {
    float sum = 0;
    double frequency = 1 / pattern_.scale;
    float weight = 1;
    for (int k = 0; k < pattern_.octaves; ++k) {
        const std::uint32_t seed = octaveSeed(pattern_.seed, k);
        const Vec3d cell = p * frequency + unitVector(seed);
        if (!(maxComponent(abs(cell)) < kFarthest)) break;
        const LatticePlace place(cell);
        switch (pattern_.kind) {
        case NoiseKind::gradient:
            sum += weight * gradientNoise(place, seed);
            break;
        case NoiseKind::billow:
            sum += weight * std::abs(gradientNoise(place, seed));
            break;
        case NoiseKind::cellular:
            sum -= weight * cellularNoise(place, seed);
            break;
        }
        frequency *= pattern_.lacunarity;
        weight *= static_cast<float>(pattern_.gain);
    }
    return sum;
}

Vec3d NoiseField::warped(Vec3d p) const noexcept {
    if (pattern_.warp == 0) return p;
    const double frequency = 1 / pattern_.scale;
    if (!(maxComponent(abs(p)) * frequency < kFarthest)) return p;
    Vec3 shift;
    for (int k = 0; k < 2; ++k) {
        const std::uint32_t seed = octaveSeed(~pattern_.seed, k);
        const LatticePlace place(p * (frequency * (k + 1)) + unitVector(seed));
        shift += Vec3{gradientNoise(place, seed ^ 0x68bc21ebu), gradientNoise(place, seed ^ 0x02e5be93u),
                      gradientNoise(place, seed ^ 0x967a889bu)} *
                 (1 / static_cast<float>(k + 1));
    }
    return p + Vec3d(shift) * (pattern_.warp * pattern_.scale);
}

} // namespace abbe
