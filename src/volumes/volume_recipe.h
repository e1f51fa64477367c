// Procedural volumes as functions of place: what `abbe volume make` writes.
#pragma once

#include "math/bounds.h"
#include "math/vec.h"
#include "volumes/noise.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace abbe {

struct RecipeField {
    std::string_view name, unit;
    int components = 1; // or 3
};

// The values of 8³ voxels, z fastest, one array per component of all fields in order.
struct RecipeLeaf {
    static constexpr int kVoxels = 512;
    using Values = std::array<float, kVoxels>;
    std::vector<Values> components;
};

// Immutable; any number of threads may evaluate leaves. The same seed gives the same volume at any resolution, with
// more or fewer details.
class VolumeRecipe {
  public:
    virtual ~VolumeRecipe() = default;
    // Metres, y up. Outside everything is 0.
    virtual Bounds3 bounds() const = 0;
    virtual std::span<const RecipeField> fields() const = 0;
    // Evaluates the voxels with centres corner + (i, j, k)·size. False if all are 0; the values are then not set.
    virtual bool leaf(Vec3 corner, float size, RecipeLeaf& leaf) const = 0;
};

// "cumulus" (1 km wide: density), "smoke" (a plume of 6 m: density, velocity), "fire" (2 m high) or "candle" (3 cm
// high; both: density, temperature, flame). nullptr for other names.
std::unique_ptr<VolumeRecipe> makeVolumeRecipe(std::string_view kind, std::uint32_t seed);

std::unique_ptr<VolumeRecipe> makeCumulus(std::uint32_t seed);
std::unique_ptr<VolumeRecipe> makeSmoke(std::uint32_t seed);
std::unique_ptr<VolumeRecipe> makeFire(std::uint32_t seed);
std::unique_ptr<VolumeRecipe> makeCandle(std::uint32_t seed);

// For recipes that compute each voxel by itself.
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
