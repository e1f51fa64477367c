// What planning remembers of a light path.
#pragma once

#include <cstdint>

namespace abbe {

// Where it started.
struct LightStart {
    std::uint32_t light = 0;
    std::uint32_t target = 0; // one more than the number of what it was aimed at; 0: not aimed
    std::uint32_t part = 0;   // of the target's cone: cell of the finest AimGrid
};

// Light that it showed to the lens.
struct LightDeposit {
    LightStart start;
    bool spread = false;  // before it came here
    int x = 0, y = 0;     // pixel
    double luminance = 0; // that one of as many light paths as the frame has pixels brings to the pixel, without weight
    double stands = 1;    // for how many such paths
    double rho = 0;       // how many times as likely one camera path a pixel is to find the same
};

} // namespace abbe
