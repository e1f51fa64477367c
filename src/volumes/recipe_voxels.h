// For recipes that compute each voxel by itself.
#pragma once

#include "volumes/noise.h"
#include "volumes/volume_recipe.h"

namespace abbe {

// `recipe.voxel(place, values)` sets all components at a place, or says that nothing is there; at most six.
template <typename Recipe> bool eachVoxel(const Recipe& recipe, Vec3 corner, float size, RecipeLeaf& out) {
    bool any = false;
    float values[6];
    for (std::size_t i = 0; i < RecipeLeaf::kVoxels; ++i) {
        const Vec3 p = corner + Vec3(float(i >> 6), float(i >> 3 & 7), float(i & 7)) * size;
        const bool here = recipe.voxel(p, values);
        any = any || here;
        for (std::size_t c = 0; c < out.components.size(); ++c) out.components[c][i] = here ? values[c] : 0;
    }
    return any;
}

} // namespace abbe
