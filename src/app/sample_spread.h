// What an adaptive render says about how it spread its samples.
#pragma once

#include "film/pixel_film.h"

#include <cstdint>
#include <string>

namespace abbe {

// Samples of pixels, all replicates together.
struct SampleSpread {
    std::uint64_t least = 0, most = 0;
    double mean = 0;

    bool even() const { return least == most; }
    std::string text() const; // "from 16 to 512, 61.3 on average"
};

// No thread may be adding.
SampleSpread sampleSpread(const PixelFilm&);

} // namespace abbe
