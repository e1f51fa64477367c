// Who hears of light asked for by manifold sampling.
#pragma once

#include "integrators/manifold_sampler.h"

namespace abbe {

// For pilots. Called by one thread.
class ManifoldListener {
  public:
    virtual ~ManifoldListener() = default;
    // A path of throughput `beta` asked at `start` and was told of `light` at the eye; a path that meets the same lamp
    // by chance would bring `chance`. Both 0 if nothing was found. Called for each of the plan's estimates; `light` is
    // that of one, not its share of the mean.
    virtual void asked(const ChainStart& start, const Spectrum& beta, const Wavelengths&, const Spectrum& light,
                       const Spectrum& chance) = 0;
};

} // namespace abbe
