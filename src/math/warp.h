// Maps from the unit square to domains of sampling, each with its density and its inverse.
#pragma once

#include "math/vec.h"

#include <bit>
#include <cstdint>

namespace abbe {

// condition ? yes : no without a branch.
inline float blend(bool condition, float yes, float no) {
    const std::uint32_t mask = 0u - static_cast<std::uint32_t>(condition);
    return std::bit_cast<float>((std::bit_cast<std::uint32_t>(yes) & mask) |
                                (std::bit_cast<std::uint32_t>(no) & ~mask));
}

// Sine and cosine of x in [-π/4, π/4] by Taylor polynomials; absolute error below 1e-7.
struct SinCos {
    float sin, cos;
};
inline SinCos sinCosEighth(float x) {
    const float x2 = x * x;
    return {x * (1 + x2 * (-1.f / 6 + x2 * (1.f / 120 - x2 * (1.f / 5040)))),
            1 + x2 * (-0.5f + x2 * (1.f / 24 + x2 * (-1.f / 720 + x2 * (1.f / 40320))))};
}

// Unit square to unit disk, area preserving up to the factor π, with little distortion [Shirley1997]. Which of the two
// coordinates is the larger is a coin toss that no branch predictor wins, so both cases share their arithmetic.
inline Vec2 squareToDisk(Vec2 u) {
    const float a = 2 * u.x - 1, b = 2 * u.y - 1;
    const bool aLarger = std::abs(a) > std::abs(b);
    const float radius = blend(aLarger, a, b), other = blend(aLarger, b, a);
    if (radius == 0) return {};
    const SinCos sc = sinCosEighth(kPi / 4 * (other / radius));
    return {radius * blend(aLarger, sc.cos, sc.sin), radius * blend(aLarger, sc.sin, sc.cos)};
}
inline Vec2 diskToSquare(Vec2 p) {
    const float r = std::sqrt(p.x * p.x + p.y * p.y);
    if (r == 0) return {0.5f, 0.5f};
    float a, b;
    if (std::abs(p.x) > std::abs(p.y)) {
        a = std::copysign(r, p.x);
        b = a * (4 / kPi) * std::atan(p.y / p.x);
    } else {
        b = std::copysign(r, p.y);
        a = b * (4 / kPi) * std::atan(p.x / p.y);
    }
    return {0.5f * (a + 1), 0.5f * (b + 1)};
}
inline constexpr float kDiskPdf = kInvPi;

// Cosine-weighted direction about +z: the disk lifted to the hemisphere (Malley's method).
inline Vec3 squareToCosineHemisphere(Vec2 u) {
    const Vec2 d = squareToDisk(u);
    return {d.x, d.y, safeSqrt(1 - d.x * d.x - d.y * d.y)};
}
inline Vec2 cosineHemisphereToSquare(Vec3 w) { return diskToSquare({w.x, w.y}); }
inline float cosineHemispherePdf(float cosTheta) { return cosTheta > 0 ? cosTheta * kInvPi : 0; }

// Uniform direction.
inline Vec3 squareToSphere(Vec2 u) {
    const float z = 1 - 2 * u.x, r = safeSqrt(1 - z * z), phi = 2 * kPi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), z};
}
inline Vec2 sphereToSquare(Vec3 w) {
    const float phi = std::atan2(w.y, w.x);
    return {0.5f * (1 - w.z), (phi < 0 ? phi + 2 * kPi : phi) * (0.5f * kInvPi)};
}
inline constexpr float kSpherePdf = 0.25f * kInvPi;

// Uniform direction within a cone about +z, given 1 - cos of its half angle: the difference itself, because the cosine
// of a small cone rounds to 1 (docs/hard_cases.md, case 30).
inline Vec3 squareToCone(Vec2 u, float oneMinusCosMax) {
    const float h = u.x * oneMinusCosMax; // 1 - cos θ
    const float r = safeSqrt(h * (2 - h)), phi = 2 * kPi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), 1 - h};
}
inline float conePdf(float oneMinusCosMax) { return 1 / (2 * kPi * oneMinusCosMax); }
// 1 - cos θ from sin θ without cancellation, θ in [0, π/2].
inline float oneMinusCos(float sinTheta) {
    const float s2 = sinTheta * sinTheta;
    return s2 / (1 + safeSqrt(1 - s2));
}

// Uniform barycentric coordinates (b1, b2) of a triangle; b0 = 1 - b1 - b2 [Heitz2019].
inline Vec2 squareToTriangle(Vec2 u) {
    float b0, b1;
    if (u.x < u.y) {
        b0 = u.x / 2;
        b1 = u.y - b0;
    } else {
        b1 = u.y / 2;
        b0 = u.x - b1;
    }
    return {b1, std::max(0.f, 1 - b0 - b1)};
}

} // namespace abbe
