// Where a time lies among equally spaced steps, in Embree's own arithmetic: what it intersects and what the shapes
// compute from a hit must be the same surface.
#pragma once

#include "render/shape.h"

namespace abbe {

struct StepPosition {
    std::uint32_t step = 0; // and the next one
    float fraction = 0;
};

// Requires at least two steps and a time in [0, 1].
inline StepPosition stepAt(float time, std::size_t steps) {
    const float parts = static_cast<float>(steps - 1), scaled = time * parts;
    const float step = std::clamp(std::floor(scaled), 0.f, parts - 1);
    return {static_cast<std::uint32_t>(step), scaled - step};
}

inline float between(float a, float b, float fraction) { return std::fma(1 - fraction, a, fraction * b); }
inline Vec3 between(Vec3 a, Vec3 b, float fraction) {
    return {between(a.x, b.x, fraction), between(a.y, b.y, fraction), between(a.z, b.z, fraction)};
}
inline SizedPoint between(const SizedPoint& a, const SizedPoint& b, float fraction) {
    return {between(a.position, b.position, fraction), between(a.radius, b.radius, fraction)};
}

} // namespace abbe
