// How noisy camera paths are where light paths may take part.
#pragma once

#include "integrators/light_path_plan.h"
#include "integrators/noise_measure.h"
#include "integrators/tile_kernel.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// What camera paths bring, relative and in the mean over the frame as NoiseMeasure has it.
struct CameraVariance {
    static constexpr std::uint32_t kMany = 64; // samples of a pixel: a power of two, and the square of another

    double secondMoment = 0, variance = 0; // of one sample
    double ofMeans = 0;                    // variance of the mean of kMany samples of one pixel, times their number

    // The same of 512 samples, for which renders are planned, whatever their number is. Samples of a pixel are
    // stratified, and what that takes off the variance grows by a power of their number.
    double planned() const { return variance > 0 ? ofMeans * std::min(1.0, std::sqrt(ofMeans / variance)) : 0; }
};

struct CameraNoise {
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
