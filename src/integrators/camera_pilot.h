// How noisy camera paths are where light paths may take part.
#pragma once

#include "integrators/light_path_plan.h"
#include "integrators/noise_measure.h"
#include "integrators/tile_kernel.h"

namespace abbe {

// What camera paths bring, relative and in the mean over the frame as NoiseMeasure has it: the second moment of a
// sample, and the variance of the mean of many samples of one pixel, times their number. Samples of a pixel are
// stratified, which takes more off the variance than the square of the mean.
struct CameraVariance {
    double secondMoment = 0, ofMeans = 0;
};

struct CameraNoise {
    static constexpr std::uint32_t kMany = 64; // samples of a pixel

    CameraVariance shared; // the light that light paths could bring, as camera paths find it without them
    CameraVariance rest;   // everything else
    double rays = 0;       // of a camera path, without the cost of weights
    std::uint64_t pilotRays = 0;
};

// A look at an even grid of pixels. `plan` says what light paths could bring; `context` has none. Depends on the frame
// and the seed of the context alone.
CameraNoise cameraNoise(const PathContext&, TileFunction traced, const RouletteReference&, const LightPathPlan&,
                        const NoiseMeasure&);

} // namespace abbe
