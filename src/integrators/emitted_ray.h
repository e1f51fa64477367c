// The first segment of a path of light.
#pragma once

#include "integrators/emission_density.h"
#include "render/light.h"
#include "render/ray.h"

#include <cstdint>

namespace abbe {

struct EmittedRay {
    static constexpr std::uint32_t kNoTarget = 0xffffffffu;

    const Light* light = nullptr;
    std::uint32_t part = 0;
    std::uint32_t target = kNoTarget; // which of the plan's it was aimed at
    // Free of the light's own surface. From far away it starts where all finite geometry and all targets still lie
    // ahead: only shapes without an end may shade it there, which a ray backwards tells.
    Ray ray;
    Vec2 aim;      // where in the square of that target's cone or disk (AimGrid)
    Vec3 n;        // unit normal of the light's surface, outside; 0 where it has none
    Spectrum beta; // W·nm⁻¹: radiance cos θ / density. Its mean over rays is the power of all lights
    EmissionDensity density;
    bool deltaPosition = false, deltaDirection = false;
    bool unmet = false; // a camera path cannot meet the light, as it is one of these or has no body
};

} // namespace abbe
