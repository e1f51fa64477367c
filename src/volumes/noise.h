// Noise fields in space: pure functions of place and seed, the same on every machine.
#pragma once

#include "math/hash.h"
#include "math/vec.h"

#include <cstdint>

namespace abbe {

// Hash of a lattice point.
inline std::uint32_t latticeHash(int x, int y, int z, std::uint32_t seed) {
    return mix32(static_cast<std::uint32_t>(x) * 0x8da6b343u + static_cast<std::uint32_t>(y) * 0xd8163841u +
                 static_cast<std::uint32_t>(z) * 0xcb1ab31fu + seed);
}

// Where a point is among lattice cells. Made from double, noise keeps its digits far from the origin; the lattice
// repeats after 2^32 cells.
struct LatticePlace {
    std::uint32_t x = 0, y = 0, z = 0; // the cell
    Vec3 f;                            // within it, in [0, 1]

    // Requires: |p| < 2^62.
    explicit LatticePlace(Vec3d p) {
        const Vec3d whole{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
        const auto cell = [](double c) { return static_cast<std::uint32_t>(static_cast<std::int64_t>(c)); };
        x = cell(whole.x), y = cell(whole.y), z = cell(whole.z);
        f = Vec3(p - whole);
    }
    // Requires: |p| < 2^30.
    explicit LatticePlace(Vec3 p) : LatticePlace(Vec3d(p)) {}

    std::uint32_t hash(int i, int j, int k, std::uint32_t seed) const {
        const auto moved = [](std::uint32_t cell, int by) {
            return static_cast<int>(cell + static_cast<std::uint32_t>(by));
        };
        return latticeHash(moved(x, i), moved(y, j), moved(z, k), seed);
    }
};

// Gradient noise [Perlin2002] with quintic weights: about [-1, 1], 0 at lattice points, twice differentiable.
inline float gradientNoise(const LatticePlace& p, std::uint32_t seed) {
    const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const auto corner = [&](int i, int j, int k) {
        const std::uint32_t h = p.hash(i, j, k, seed);
        const auto part = [h](int shift) { return static_cast<float>((h >> shift) & 1023) * (2.f / 1023) - 1; };
        return part(0) * (p.f.x - static_cast<float>(i)) + part(10) * (p.f.y - static_cast<float>(j)) +
               part(20) * (p.f.z - static_cast<float>(k));
    };
    const float u = fade(p.f.x), v = fade(p.f.y), w = fade(p.f.z);
    const float a = lerp(lerp(corner(0, 0, 0), corner(0, 0, 1), w), lerp(corner(0, 1, 0), corner(0, 1, 1), w), v);
    const float b = lerp(lerp(corner(1, 0, 0), corner(1, 0, 1), w), lerp(corner(1, 1, 0), corner(1, 1, 1), w), v);
    return lerp(a, b, u);
}
inline float gradientNoise(Vec3 p, std::uint32_t seed) { return gradientNoise(LatticePlace(p), seed); }

// Octaves of gradient noise, each of twice the frequency and half the amplitude: about [-1, 1].
inline float fractalNoise(Vec3 p, int octaves, std::uint32_t seed) {
    float sum = 0, amplitude = 0.5f;
    for (int i = 0; i < octaves; ++i) {
        sum += amplitude * gradientNoise(p, seed + static_cast<std::uint32_t>(i) * 0x9e3779b9u);
        amplitude *= 0.5f;
        p = p * 2 + Vec3(0.37f, 0.71f, 0.13f); // lattices of the octaves do not coincide
    }
    return sum;
}

// Three independent fractal noises.
inline Vec3 fractalVector(Vec3 p, int octaves, std::uint32_t seed) {
    return {fractalNoise(p, octaves, seed ^ 0x68bc21ebu), fractalNoise(p, octaves, seed ^ 0x02e5be93u),
            fractalNoise(p, octaves, seed ^ 0x967a889bu)};
}

// Cellular noise [Worley1996]: distance to the nearest of the points strewn one per cell, at most about 1.2.
inline float cellularNoise(const LatticePlace& p, std::uint32_t seed) {
    float nearest = 4;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k) {
                const std::uint32_t h = p.hash(i, j, k, seed);
                const auto part = [h](int shift) { return static_cast<float>((h >> shift) & 1023) * (1.f / 1024); };
                const Vec3 d{static_cast<float>(i) + part(0) - p.f.x, static_cast<float>(j) + part(10) - p.f.y,
                             static_cast<float>(k) + part(20) - p.f.z};
                nearest = std::min(nearest, lengthSquared(d));
            }
    return std::sqrt(nearest);
}
inline float cellularNoise(Vec3 p, std::uint32_t seed) { return cellularNoise(LatticePlace(p), seed); }

// 0 below a, 1 above b, smooth between.
inline float smoothStep(float a, float b, float x) {
    const float t = std::clamp((x - a) / (b - a), 0.f, 1.f);
    return t * t * (3 - 2 * t);
}

} // namespace abbe
