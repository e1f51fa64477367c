// From the lanes of a path to the bins of spectral layers.
#pragma once

#include "film/layer_plan.h"
#include "spectrum/wavelengths.h"

#include <cstddef>

namespace abbe {

// Each lane is an estimate of the radiance at its wavelength with a density of its own; a bin gets those within it, so
// that it holds the mean spectral radiance over its width, without bias, also where all lanes but the hero's ended.
// Calls add(bin, term) for each lane within the bins.
template <typename Add>
void spreadOverBins(const SpectralBins& bins, const Spectrum& radiance, const Wavelengths& lambda, double factor,
                    const Add& add) {
    const double scale = factor / (kLanes * bins.width);
    for (int lane = 0; lane < kLanes; ++lane) {
        const double place = (static_cast<double>(lambda.nm[lane]) - bins.first) / bins.width;
        if (place < 0 || place >= bins.count()) continue;
        add(static_cast<std::size_t>(place),
            static_cast<double>(radiance[lane]) / static_cast<double>(lambda.pdf[lane]) * scale);
    }
}

} // namespace abbe
