#include "lights/light_context.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

Receiver LightPose::rest(const Receiver& from) const {
    if (!from.surface) return {rest(from.p)};
    return {rest(from.p), Vec3(normalize(toRest.vector(Vec3d(from.n)))), from.twoSided};
}

SurfaceHit LightPose::rest(const SurfaceHit& hit) const {
    SurfaceHit result = hit;
    result.p = rest(hit.p);
    result.ng = Vec3(normalize(toRest.normal(Vec3d(hit.ng))));
    return result;
}

bool LightMotion::keepsShape(const Motion& fromRest, Interval shutter) {
    constexpr int samples = 64;
    for (int i = 0; i <= samples; ++i) {
        const Transform m = fromRest.at(shutter.open + shutter.duration * i / samples);
        const auto scale = m.uniformScale();
        if (!scale || !(*scale > 0) || !(m.determinant() > 0)) return false;
    }
    return true;
}

// At 129 times; between two of them nothing is farther off than the longest step, nor turned farther than the largest
// angle.
std::optional<LightBounds> LightMotion::swept(const LightBounds& rest) const {
    constexpr int steps = 128;
    const auto corner = [&rest](int i) {
        return Vec3d(i & 1 ? rest.box.upper.x : rest.box.lower.x, i & 2 ? rest.box.upper.y : rest.box.lower.y,
                     i & 4 ? rest.box.upper.z : rest.box.lower.z);
    };
    Bounds3d box;
    std::array<Vec3d, 8> last;
    Vec3d sum, lastAxis;
    std::array<Vec3d, steps + 1> axes;
    double longest = 0, largest = 0;
    for (int step = 0; step <= steps; ++step) {
        const auto pose = at(static_cast<float>(step) / steps);
        if (!pose) return std::nullopt;
        for (int i = 0; i < 8; ++i) {
            const Vec3d p = pose->toRender.point(corner(i));
            if (step > 0) longest = std::max(longest, length(p - last[i]));
            box.add(last[i] = p);
        }
        axes[step] = normalize(pose->toRender.vector(Vec3d(rest.axis)));
        if (step > 0) largest = std::max(largest, length(axes[step] - lastAxis));
        sum += lastAxis = axes[step];
    }
    LightBounds result = rest;
    const Vec3d margin = abs(box.centre()) * 0x1p-20 + Vec3d(longest, longest, longest);
    result.box = {Vec3(box.lower - margin), Vec3(box.upper + margin)};
    if (rest.cosNormals <= -1) return result;
    result.cosNormals = -1;
    if (!(length(sum) > 0.1 * steps)) return result; // turns far round
    const Vec3d axis = normalize(sum);
    double widest = 0;
    for (const Vec3d& a : axes) widest = std::max(widest, 2 * std::asin(std::min(1.0, length(a - axis) / 2)));
    const double half = std::acos(static_cast<double>(rest.cosNormals)) + widest + 2 * largest;
    if (half < kPiD) {
        result.axis = Vec3(axis);
        result.cosNormals = static_cast<float>(std::cos(half));
    }
    return result;
}

std::optional<LightPose> LightMotion::at(float time) const {
    const Transform m = fromRest_.at(shutter_.open + shutter_.duration * static_cast<double>(time));
    const auto inverse = m.inverse();
    if (!inverse) return std::nullopt;
    return LightPose{m, *inverse, std::cbrt(m.determinant())};
}

} // namespace abbe
