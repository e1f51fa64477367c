#include "geometry/spherical_rectangle.h"

#include "math/warp.h"

#include <bit>
#include <cstdint>

namespace abbe {

namespace {

// atan on [0, 1], absolute error below 2e-7: minimax polynomial in x², degree 17 in x.
inline float atanUnit(float x) {
    const float z = x * x;
    float r = 0.0028662257f;
    r = std::fma(r, z, -0.0161657367f);
    r = std::fma(r, z, 0.0429096138f);
    r = std::fma(r, z, -0.0752896400f);
    r = std::fma(r, z, 0.1065626393f);
    r = std::fma(r, z, -0.1420889944f);
    r = std::fma(r, z, 0.1999355085f);
    r = std::fma(r, z, -0.3333314528f);
    return std::fma(r * z, x, x);
}

// The angle in [0, π] of (cosine, sine), sine >= 0, not both 0.
inline float angle(float cosine, float sine) {
    const float c = std::abs(cosine);
    const float a = atanUnit(std::min(c, sine) / std::max(c, sine));
    const float first = sine > c ? kPi / 2 - a : a;
    return cosine < 0 ? kPi - first : first;
}

// Sine and cosine of x in [-2π, 2π]: quarter turns are taken off in two steps, the second for the digits that π/2 as
// a float lacks.
inline SinCos sinCosTurn(float x) {
    const float turns = std::nearbyint(x * (2 / kPi));
    const float rest = std::fma(turns, 4.371139e-8f, std::fma(turns, -1.57079637f, x));
    const SinCos r = sinCosEighth(rest);
    // The quarter turns swap and negate; written without branches, which random angles would mispredict.
    const auto quarter = static_cast<std::uint32_t>(static_cast<std::int32_t>(turns));
    const std::array<float, 2> table{r.sin, r.cos};
    const auto negated = [](float v, std::uint32_t bit1) {
        return std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) ^ ((bit1 & 2) << 30));
    };
    return {negated(table[quarter & 1], quarter), negated(table[~quarter & 1], quarter + 1)};
}

} // namespace

SphericalRectangle::SphericalRectangle(float x0, float y0, float x1, float y1, float z)
    : x0_(x0), y0_(y0), x1_(x1), y1_(y1), z_(-std::abs(z)), k_(0), solidAngle_(0) {
    // Planes through the sides in turn: y = y0, x = x1, y = y1, x = x0. cosine[i] is the z component of the unit
    // normal, sine[i] = sqrt(1 - cosine²).
    const std::array<float, 4> offset{-y0, x1, y1, -x0};
    std::array<float, 4> cosine, sine, gamma;
    for (int i = 0; i < 4; ++i) {
        const float inverse = 1 / std::sqrt(std::fma(z, z, offset[i] * offset[i]));
        cosine[i] = offset[i] * inverse;
        sine[i] = -z_ * inverse;
    }
    b0_ = cosine[0];
    b1_ = cosine[2];
    sine0_ = sine[0];
    if (!(z_ < 0)) return;
    for (int i = 0; i < 4; ++i) {
        const int j = (i + 1) % 4;
        const float a2 = sine[i] * sine[i], b2 = sine[j] * sine[j];
        gamma[i] = angle(-cosine[i] * cosine[j], std::sqrt(std::max(0.f, a2 + b2 - a2 * b2)));
    }
    k_ = 2 * kPi - gamma[2] - gamma[3];
    solidAngle_ = std::max(0.f, gamma[0] + gamma[1] - k_);
}

Vec2 SphericalRectangle::sample(Vec2 u) const {
    // [Urena2013], with both sides of the fraction under x multiplied by sin a, so that sin a = 0 is x = 0
    // and nothing is divided twice, and with 1 - c_u² as a product that does not cancel.
    const SinCos angle = sinCosTurn(std::fma(u.x, solidAngle_, k_));
    const float f = angle.cos * b0_ - b1_, s = sine0_ * angle.sin;
    const float along = std::sqrt(std::max(0.f, (f - s) * (f + s)));
    // along = 0 is x at infinity: the clamp settles it; 0 / 0 is only met when the rectangle has no width.
    float x = std::copysign(z_, f) * angle.sin / along;
    if (!(x == x)) x = 0;
    x = std::clamp(x, x0_, x1_);
    const float d2 = std::fma(x, x, z_ * z_);
    const float h0 = y0_ / std::sqrt(std::fma(y0_, y0_, d2)), h1 = y1_ / std::sqrt(std::fma(y1_, y1_, d2));
    const float h = std::fma(u.y, h1 - h0, h0);
    const float y = h * std::sqrt(d2 / std::max(1e-30f, (1 - h) * (1 + h)));
    return {x, std::clamp(y, y0_, y1_)};
}

// The first coordinate is the share of the solid angle on this side of x.
Vec2 SphericalRectangle::inverse(Vec2 point) const {
    const SphericalRectangle before(x0_, y0_, point.x, y1_, z_);
    const float d2 = std::fma(point.x, point.x, z_ * z_);
    const auto height = [d2](float y) { return y / std::sqrt(std::fma(y, y, d2)); };
    const float h0 = height(y0_), h1 = height(y1_), h = height(point.y);
    return {std::clamp(before.solidAngle() / solidAngle_, 0.f, 1.f), std::clamp((h - h0) / (h1 - h0), 0.f, 1.f)};
}

} // namespace abbe
