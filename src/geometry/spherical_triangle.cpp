#include "geometry/spherical_triangle.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// The unit vector along the part of v that is at right angles to the unit vector n; 0 where there is none.
Vec3d across(Vec3d v, Vec3d n) {
    const Vec3d part = v - n * dot(v, n);
    const double l = length(part);
    return l > 0 ? part / l : Vec3d();
}

// Of unit vectors [VanOosterom1983], with the volume from differences of the corners: the sum of the angles less π
// would lose all digits of small triangles (docs/hard_cases.md, case 31).
double solidAngleOf(Vec3d a, Vec3d b, Vec3d c) {
    const double volume = std::abs(dot(a, cross(b - a, c - a)));
    return 2 * std::atan2(volume, 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

} // namespace

SphericalTriangle::SphericalTriangle(Vec3d a, Vec3d b, Vec3d c)
    : a_(normalize(a)), b_(normalize(b)), c_(normalize(c)), solidAngle_(solidAngleOf(a_, b_, c_)) {}

// A smaller triangle with the share u.x of the area, whose corner is C' on the side from a to c; then a point on the
// arc from b to C'.
Vec3d SphericalTriangle::direction(Vec2 u) const {
    const Vec3d n1 = cross(a_, b_), n2 = cross(a_, c_);
    const double alpha = std::atan2(length(cross(n1, n2)), dot(n1, n2));
    const double phi = static_cast<double>(u.x) * solidAngle_ - alpha;
    const double s = std::sin(phi), t = std::cos(phi), cosAlpha = std::cos(alpha), sinAlpha = std::sin(alpha);
    const double p = t - cosAlpha, q = s + sinAlpha * dot(a_, b_);
    const double below = (q * s + p * t) * sinAlpha;
    double cosine = below != 0 ? ((q * t - p * s) * cosAlpha - q) / below : 1;
    cosine = std::clamp(cosine, dot(a_, c_), 1.0); // between the corners
    const Vec3d corner = a_ * cosine + across(c_, a_) * safeSqrt(1 - cosine * cosine);
    const double z = 1 - static_cast<double>(u.y) * (1 - dot(corner, b_));
    return b_ * z + across(corner, b_) * safeSqrt(1 - z * z);
}

Vec2 SphericalTriangle::inverse(Vec3d w) const {
    Vec3d corner = cross(cross(b_, w), cross(c_, a_));
    const double l = length(corner);
    if (!(l > 0)) return {}; // at b, where all u.x meet
    corner = corner * ((dot(corner, a_ + c_) < 0 ? -1 : 1) / l);
    const double x = solidAngleOf(a_, b_, corner) / solidAngle_;
    const double y = lengthSquared(w - b_) / lengthSquared(corner - b_);
    return {static_cast<float>(std::clamp(x, 0.0, 1.0)), static_cast<float>(std::clamp(y, 0.0, 1.0))};
}

} // namespace abbe
