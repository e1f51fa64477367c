#include "geometry/projected_cap.h"

#include "math/frame.h"
#include "math/warp.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// ∫₀ʸ √(1 - t²/b²) dt.
double underEllipse(double y, double b) {
    const double s = std::clamp(y / b, -1.0, 1.0);
    return 0.5 * b * (s * std::sqrt(1 - s * s) + std::asin(s));
}

} // namespace

std::optional<ProjectedCap> ProjectedCap::seen(const Receiver& from, Vec3d axis, double d2, double r2) {
    constexpr double kSmallest = 0.01; // sine², 6°
    const double sin2 = r2 / d2;
    if (!from.oneSided() || !(sin2 > kSmallest)) return std::nullopt;
    ProjectedCap c;
    c.n_ = Vec3d(from.n);
    const double height = dot(axis, c.n_), sine = std::sqrt(sin2), cosine = std::sqrt(1 - sin2);
    if (!(height > -0.99 * sine)) return std::nullopt;
    const Vec3d side = axis - c.n_ * height;
    const double along = length(side);
    c.x_ = along > 1e-9 ? side / along : Vec3d(Frame::fromNormal(from.n).x);
    c.y_ = cross(c.n_, c.x_);
    c.centre_ = along * cosine;
    c.a_ = sine * height;
    c.b_ = sine;
    if (height >= sine) {
        c.solidAngle_ = kPiD * sin2 * height;
        return c;
    }
    c.tangent_ = safeSqrt(1 - (cosine / along) * (cosine / along));
    c.middleArea_ = c.middle(c.tangent_);
    c.solidAngle_ = 2 * (c.middleArea_ + (c.a_ > 0 ? c.wing(c.b_) : 0));
    return c.solidAngle_ > 0 ? std::optional(c) : std::nullopt;
}

// The area between the near side of the ellipse and the arc, from the x axis to y.
double ProjectedCap::middle(double y) const { return underEllipse(y, 1) - centre_ * y + a_ * underEllipse(y, b_); }

// The area within the ellipse from the tangent to y.
double ProjectedCap::wing(double y) const { return 2 * a_ * (underEllipse(y, b_) - underEllipse(tangent_, b_)); }

// The y up to which the half y > 0 has this area: Newton's method, kept in a bracket.
double ProjectedCap::inverse(double area) const {
    const bool inMiddle = area <= middleArea_ || !(a_ > 0);
    double low = inMiddle ? 0 : tangent_, high = inMiddle ? tangent_ : b_, y = 0.5 * (low + high);
    for (int i = 0; i < 60 && high - low > 1e-14; ++i) {
        const double excess = inMiddle ? middle(y) - area : middleArea_ + wing(y) - area;
        (excess > 0 ? high : low) = y;
        const double q = safeSqrt(1 - (y / b_) * (y / b_));
        const double width = inMiddle ? safeSqrt(1 - y * y) - centre_ + a_ * q : 2 * a_ * q;
        const double next = y - excess / width;
        if (std::abs(next - y) < 1e-13) break;
        y = next > low && next < high ? next : 0.5 * (low + high);
    }
    return y;
}

Vec2d ProjectedCap::place(Vec2 u) const {
    if (tangent_ == 0) {
        const Vec2 d = squareToDisk(u);
        return {centre_ + a_ * static_cast<double>(d.x), b_ * static_cast<double>(d.y)};
    }
    const double v = 2 * static_cast<double>(u.x) - 1;
    const double y = inverse(std::abs(v) * 0.5 * solidAngle_);
    const double near = a_ * safeSqrt(1 - (y / b_) * (y / b_));
    const double from = centre_ - near, to = y <= tangent_ ? safeSqrt(1 - y * y) : centre_ + near;
    return {std::lerp(from, to, static_cast<double>(u.y)), std::copysign(y, v)};
}

Vec3d ProjectedCap::direction(Vec2 u) const {
    const Vec2d p = place(u);
    return normalize(x_ * p.x + y_ * p.y + n_ * safeSqrt(1 - p.x * p.x - p.y * p.y));
}

double ProjectedCap::pdf(Vec3d w) const { return std::max(0.0, dot(w, n_)) / solidAngle_; }

} // namespace abbe
