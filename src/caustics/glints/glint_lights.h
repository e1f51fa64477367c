// Lights that are small enough to be seen as glints.
#pragma once

#include "render/scene.h"

#include <vector>

namespace abbe {

// Render space.
struct GlintLight {
    const Light* source = nullptr;
    bool distant = false;
    Vec3 place;     // unit direction to its middle, or the middle
    float size = 0; // radius, rad or m

    // Unit direction to its middle, and the sine of half the angle that it fills.
    Vec3 from(Vec3 p) const { return distant ? place : normalize(place - p); }
    float sine(Vec3 p) const { return distant ? size : size / length(place - p); }
};

// The brightest of those that rays can meet, at most so many.
std::vector<GlintLight> glintLights(const Scene&, std::size_t most);

} // namespace abbe
