// Where a portion of samples was cut short.
#pragma once

#include <cstdint>

namespace abbe {

// Samples of a tile are taken unit by unit: of pixels, row by row, and of each its replicates. Of light paths a unit is
// a sample of a replicate, and of merging a round.
struct PortionPlace {
    std::uint32_t unit = 0; // all units before it are done,
    std::uint32_t done = 0; // and so many samples, or light paths, of this one
};

// A portion that was to take a tile to sample `end`.
struct CutPortion {
    std::uint32_t end = 0;
    PortionPlace at;
};

} // namespace abbe
