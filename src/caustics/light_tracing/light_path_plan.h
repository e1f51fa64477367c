// How light tracing takes part in a render: the plan, and what its pilot found.
#pragma once

#include "caustics/shared/aimed_emission.h"
#include "caustics/shared/light_path_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

// How many light paths there are, and where they go. Frozen before light is gathered.
struct LightPathPlan {
    AimedEmission emission;
    // Light paths for each sample of all pixels of the frame; > 0.
    std::uint32_t paths = 0;
    // `share` of them for each of so many pixels.
    static std::uint32_t pathsFor(double share, double pixels) {
        return std::max(1u, static_cast<std::uint32_t>(std::lround(share * pixels)));
    }
    // What light paths can find is left to them alone; else the two ways are weighed by the balance heuristic.
    bool alone = false;
    // Of light paths that have been spread for the first time, by a matte lobe or in a medium, those that go on; (0,
    // 1].
    float afterSpread = 1;
};

// Light paths of one light towards one target.
struct LightPathShare {
    std::string light;  // as in Scene::names; empty: all others together
    std::string target; // what focuses; empty: elsewhere, where the light itself arrives
    double share = 0;   // of all light paths
    // Relative second moments of what these paths find, as LightPathFindings::before and ::after, which are variances
    // and so less than their sums.
    double before = 0, after = 0;
};

// What was found out about light paths before a render, for people to read. All of it depends on the scene, the frame,
// the seed and the size of the pilots alone.
struct LightPathFindings {
    static constexpr std::size_t kShares = 8;

    LightPathVerdict verdict = LightPathVerdict::undecided;
    // A pilot has run: whether what follows has been measured.
    bool measured = false;
    // In the mean over pixels, as the shown noise is relative: variance of the light that light paths could bring, as
    // camera paths alone find it and as both do, and of everything else. Of the mean of 512 samples of a pixel,
    // times 512: samples of a pixel are stratified.
    double before = 0, after = 0, rest = 0;
    double gain = 1;           // of efficiency, as far as these tell, with the best share
    double share = 0;          // light paths for each camera path; 0: none
    double afterSpread = 1;    // probability to go on past the first rough surface or scattering
    double bestShare = 0;      // what was judged, whether it is taken or not
    std::uint64_t rays = 0;    // that it took to find out
    std::uint32_t lights = 0;  // of the scene
    std::uint32_t targets = 0; // what light paths are aimed at, shapes near one another put together
    // As judged, the largest first; at most kShares, the last of them stands for all further ones.
    std::vector<LightPathShare> shares;

    bool used() const { return verdict == LightPathVerdict::used || verdict == LightPathVerdict::requested; }
};

} // namespace abbe
