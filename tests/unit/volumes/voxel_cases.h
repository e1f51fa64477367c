// Small voxel grids for the tests of volumes.
#pragma once

#include "math/hash.h"
#include "support/made_grids.h"

#include <random>
#include <vector>

namespace abbe::test {

inline GridFacts facts(const char* name = "density") {
    GridFacts f;
    f.name = name;
    f.volumeClass = VolumeClass::fog;
    return f;
}

// Voxels with random values at random places of a box: crowded, with holes, and a constant block.
inline std::vector<Voxel> randomVoxels(std::uint32_t seed, int size, int count, Vec3i corner = {}) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> place(0, size - 1);
    std::uniform_real_distribution<float> value(0.f, 2.f);
    std::vector<Voxel> voxels;
    for (int i = 0; i < count; ++i)
        voxels.push_back({corner + Vec3i(place(random), place(random), place(random)), value(random)});
    return voxels;
}

inline std::vector<Voxel> block(Vec3i lower, Vec3i upper, float value) {
    std::vector<Voxel> voxels;
    for (int x = lower.x; x < upper.x; ++x)
        for (int y = lower.y; y < upper.y; ++y)
            for (int z = lower.z; z < upper.z; ++z) voxels.push_back({{x, y, z}, value});
    return voxels;
}

} // namespace abbe::test
