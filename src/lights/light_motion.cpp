#include "lights/light_motion.h"

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

std::optional<LightPose> LightMotion::at(float time) const {
    const Transform m = fromRest_.at(shutter_.open + shutter_.duration * static_cast<double>(time));
    const auto inverse = m.inverse();
    if (!inverse) return std::nullopt;
    return LightPose{m, *inverse, std::cbrt(m.determinant())};
}

} // namespace abbe
