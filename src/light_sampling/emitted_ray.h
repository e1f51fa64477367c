// Where a path of light starts, and how likely a path starts with it.
#pragma once

#include "render/light.h"
#include "render/ray.h"

#include <cmath>
#include <cstdint>

namespace abbe {

// How likely a path of light starts as it does: the densities of the steps that make its first two vertices, y0 on the
// light and y1 where it arrives, as multiple importance sampling needs them [Veach1997, sec. 8.2 and 10.2]. 0 where it
// cannot start like that.
struct EmissionDensity {
    double pick = 0;     // probability of the light and its part
    double position = 0; // 1/m²: of y0 on the light's surface, or 1 at a light that is a point; for lights far away of
                         // the line, across its direction
    double direction = 0; // 1/sr, or 1 for a light in a single direction
    bool distant = false; // y0 is infinitely far away

    double total() const { return pick * position * direction; }
    // Of y0: 1/m² on the light, or 1/sr for a light far away, what Light::sample() is to be compared with.
    double atLight() const { return pick * (distant ? direction : position); }
    // Of y1 given y0, 1/m² on its surface: `cosine` is that at y1, `distance2` m² (lights far away need none).
    double arriving(double cosine, double distance2) const {
        return std::abs(cosine) * (distant ? position : direction / distance2);
    }
};

// The first segment of a path of light.
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
