#include "cameras/exposure.h"

#include "base/check.h"
#include "math/warp.h"

#include <algorithm>
#include <cmath>

namespace abbe {

Aperture::Aperture(double radius, int blades, double rotation, double roundness)
    : radius_(radius), blades_(blades), round_(roundness) {
    ABBE_CHECK(radius >= 0 && blades >= 3 && roundness >= 0 && roundness <= 1);
    halfAngle_ = kPiD / blades;
    tanHalf_ = std::tan(halfAngle_);
    turn_ = rotation + kPiD / 2 + halfAngle_;
    // Areas in units of R².
    const double polygon = (1 - roundness) * blades * std::sin(halfAngle_) * std::cos(halfAngle_);
    const double circle = roundness * kPiD;
    straight_ = polygon / (polygon + circle);
    outer_ = radius * std::sqrt(kPiD / (polygon + circle));
    inner_ = outer_ * std::cos(halfAngle_);
}

double Aperture::edgeSquared(double tangent) const {
    const double polygon = inner_ * inner_ * (1 + tangent * tangent);
    return polygon + round_ * (outer_ * outer_ - polygon);
}

// The density of the angle is proportional to r²(φ), a mixture of sec²φ within each blade and of a constant; the
// distance is then the square root of a uniform number times the edge's.
Vec2 Aperture::sample(Vec2 u) const noexcept {
    if (blades_ == 0) return squareToDisk(u) * static_cast<float>(radius_);
    const bool straight = static_cast<double>(u.x) < straight_;
    const double v =
        straight ? static_cast<double>(u.x) / straight_ : (static_cast<double>(u.x) - straight_) / (1 - straight_);
    const double place = v * blades_;
    const double blade = std::min(std::floor(place), blades_ - 1.0);
    const double across = 2 * (place - blade) - 1;
    const double tangent = straight ? across * tanHalf_ : std::tan(across * halfAngle_);
    const double angle = straight ? std::atan(tangent) : across * halfAngle_;
    const double r = std::sqrt(static_cast<double>(u.y) * edgeSquared(tangent));
    const double phi = turn_ + 2 * halfAngle_ * blade + angle;
    return {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi))};
}

bool Aperture::contains(Vec2d p) const noexcept {
    const double r2 = p.x * p.x + p.y * p.y;
    if (blades_ == 0 || r2 > outer_ * outer_) return r2 <= outer_ * outer_;
    if (r2 <= inner_ * inner_) return true;
    return r2 <= edgeSquared(std::tan(std::remainder(std::atan2(p.y, p.x) - turn_, 2 * halfAngle_)));
}

double Shutter::position(double u) const {
    // In units of the exposure: area 1 under a trapezoid of height 1.
    const double length = 1 + 0.5 * (opening + closing);
    double t;
    if (u < 0.5 * opening)
        t = std::sqrt(2 * u * opening);
    else if (1 - u < 0.5 * closing)
        t = length - std::sqrt(2 * (1 - u) * closing);
    else
        t = u + 0.5 * opening;
    return std::clamp(t / length, 0.0, 1.0);
}

} // namespace abbe
