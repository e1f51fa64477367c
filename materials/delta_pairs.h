// Which delta lobe leads from one direction to another.
#pragma once

#include "math/vec.h"

namespace abbe {

// Their tangential parts tell, to 1e-4: directions come through frames in single precision.
inline bool nearlyEqual(Vec2 a, Vec2 b) { return square(a.x - b.x) + square(a.y - b.y) < 1e-8f; }
inline bool isMirrored(Vec3 wo, Vec3 wi) { return wo.z * wi.z > 0 && nearlyEqual({wi.x, wi.y}, {-wo.x, -wo.y}); }
inline bool isStraight(Vec3 wo, Vec3 wi) { return wo.z * wi.z < 0 && nearlyEqual({wi.x, wi.y}, {-wo.x, -wo.y}); }
// `eta`: index of the far side over that of wo's side.
inline bool isRefracted(Vec3 wo, Vec3 wi, float eta) {
    const float scale = 1 / std::max(eta, 1.f); // of the larger of both tangents
    return wo.z * wi.z < 0 && nearlyEqual(Vec2{wi.x, wi.y} * (eta * scale), Vec2{-wo.x, -wo.y} * scale);
}

} // namespace abbe
