// Noise fields in space: pure functions of place and seed, the same on every machine.
#pragma once

#include "math/hash.h"
#include "math/vec.h"

namespace abbe {

// Hash of a lattice point.
inline std::uint32_t latticeHash(int x, int y, int z, std::uint32_t seed) {
    return mix32(static_cast<std::uint32_t>(x) * 0x8da6b343u + static_cast<std::uint32_t>(y) * 0xd8163841u +
                 static_cast<std::uint32_t>(z) * 0xcb1ab31fu + seed);
}

// Gradient noise [Perlin2002] with quintic weights: about [-1, 1], 0 at lattice points, twice differentiable.
// Requires: |p| < 2^30.
inline float gradientNoise(Vec3 p, std::uint32_t seed) {
    const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
    const Vec3 f{p.x - fx, p.y - fy, p.z - fz};
    const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const auto corner = [&](int i, int j, int k) {
        const std::uint32_t h = latticeHash(x + i, y + j, z + k, seed);
        const auto part = [h](int shift) { return static_cast<float>((h >> shift) & 1023) * (2.f / 1023) - 1; };
        return part(0) * (f.x - static_cast<float>(i)) + part(10) * (f.y - static_cast<float>(j)) +
               part(20) * (f.z - static_cast<float>(k));
    };
    const float u = fade(f.x), v = fade(f.y), w = fade(f.z);
    const float a = lerp(lerp(corner(0, 0, 0), corner(0, 0, 1), w), lerp(corner(0, 1, 0), corner(0, 1, 1), w), v);
    const float b = lerp(lerp(corner(1, 0, 0), corner(1, 0, 1), w), lerp(corner(1, 1, 0), corner(1, 1, 1), w), v);
    return lerp(a, b, u);
}

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
inline float cellularNoise(Vec3 p, std::uint32_t seed) {
    const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
    float nearest = 4;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k) {
                const std::uint32_t h = latticeHash(x + i, y + j, z + k, seed);
                const auto part = [h](int shift) { return static_cast<float>((h >> shift) & 1023) * (1.f / 1024); };
                const float dx = fx + static_cast<float>(i) + part(0) - p.x;
                const float dy = fy + static_cast<float>(j) + part(10) - p.y;
                const float dz = fz + static_cast<float>(k) + part(20) - p.z;
                nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
            }
    return std::sqrt(nearest);
}

// 0 below a, 1 above b, smooth between.
inline float smoothStep(float a, float b, float x) {
    const float t = std::clamp((x - a) / (b - a), 0.f, 1.f);
    return t * t * (3 - 2 * t);
}

} // namespace abbe
