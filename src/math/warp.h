// Maps from random numbers to domains of sampling, each with its density and most with their inverse.
#pragma once

#include "math/vec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <immintrin.h>

namespace abbe {

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
// coordinates is the larger is a coin toss that no branch predictor wins, so both cases share their arithmetic, and
// swaps stay in vector registers.
inline Vec2 squareToDisk(Vec2 u) {
    const auto swapped = [](__m128 v) { return _mm_permute_ps(v, 0b11100001); };
    const __m128 p = _mm_setr_ps(2 * u.x - 1, 2 * u.y - 1, 0, 0), size = _mm_andnot_ps(_mm_set1_ps(-0.f), p);
    const __m128 firstLarger = _mm_permute_ps(_mm_cmpgt_ps(size, swapped(size)), 0);
    const auto sorted = [&](__m128 v) { return _mm_blendv_ps(swapped(v), v, firstLarger); };
    const __m128 larger = sorted(p);
    const float radius = larger[0], other = larger[1];
    if (radius == 0) return {};
    const SinCos sc = sinCosEighth(kPi / 4 * (other / radius));
    const __m128 direction = sorted(_mm_setr_ps(sc.cos, sc.sin, 0, 0));
    return {radius * direction[0], radius * direction[1]};
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

// Over the unit square, in proportion to what is bilinear between its values at the corners (0, 0), (1, 0), (0, 1) and
// (1, 1). Requires all >= 0, not all 0.
struct BilinearDensity {
    std::array<float, 4> corner;

    // u in [0, 1)².
    Vec2 sample(Vec2 u) const {
        const float y = linear(u.y, corner[0] + corner[1], corner[2] + corner[3]);
        return {linear(u.x, lerp(corner[0], corner[2], y), lerp(corner[1], corner[3], y)), y};
    }
    float pdf(Vec2 p) const {
        const float value = lerp(lerp(corner[0], corner[1], p.x), lerp(corner[2], corner[3], p.x), p.y);
        return 4 * value / (corner[0] + corner[1] + corner[2] + corner[3]);
    }

  private:
    // In proportion to a + (b - a) x.
    static float linear(float u, float a, float b) {
        if (!(u > 0)) return 0;
        const float x = u * (a + b) / (a + std::sqrt(lerp(a * a, b * b, u)));
        return std::min(x, kOneMinusEpsilon);
    }
};

// Distances along a ray, drawn by how near they come to a point [Kulla2012, §4.1].
// Density proportional to the inverse square of the distance from the point, on [tNear, tFar] of the ray; tFar may be
// infinite. Seen from the point, equal angles are equally likely.
class EquiangularDistances {
  public:
    // Requires a unit direction.
    EquiangularDistances(Vec3 origin, Vec3 direction, Vec3 point, float tNear, float tFar) {
        const Vec3d to = Vec3d(point) - Vec3d(origin);
        closest_ = dot(to, Vec3d(direction));
        const Vec3d aside = to - Vec3d(direction) * closest_;
        // On the ray itself the inverse square has no integral.
        height_ = std::max(length(aside), 1e-3 * length(to) + 1e-30);
        near_ = static_cast<double>(tNear);
        far_ = static_cast<double>(tFar);
        from_ = std::atan((near_ - closest_) / height_);
        spread_ = std::atan((far_ - closest_) / height_) - from_;
    }

    // False where the range is too small or too far away for its angles.
    bool valid() const { return spread_ > 1e-9 && spread_ < 4; }
    // u in [0, 1). Requires valid().
    float sample(float u) const {
        const double t = closest_ + height_ * std::tan(from_ + static_cast<double>(u) * spread_);
        return static_cast<float>(std::clamp(t, near_, far_));
    }
    // 1 per unit of distance; 0 outside. Requires valid().
    float pdf(float t) const {
        const double x = static_cast<double>(t);
        if (!(x >= near_ && x <= far_)) return 0;
        const double away = x - closest_;
        return static_cast<float>(height_ / (spread_ * (height_ * height_ + away * away)));
    }

  private:
    double closest_, height_, near_, far_, from_, spread_;
};

} // namespace abbe
