// The two estimators that `abbe verify` plays off against each other.
#pragma once

#include "render/technique.h"

#include <array>
#include <cstddef>

namespace abbe {

struct Estimator {
    const char* name;
    const char* how; // in a few words
    Technique technique;
};

// They have in common what both would get wrong alike: the scene, polished glass and mirrors, dispersive lobes, lights
// that cannot be met, and where light is absorbed. All else they do by different means: the first trusts the weights
// that samples of surfaces carry and finds light by scattering where it can, the second trusts values and densities
// alone and asks lights where it can. Numbers, choice of lights and roulette differ, too. No weight is more than 17
// times that of the best, nor more than the length of the path in the second: tails stay bounded. `lights`: of the
// scene.
std::array<Estimator, 2> verifyEstimators(std::size_t lights);

} // namespace abbe
