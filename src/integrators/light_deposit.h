// What planning remembers of light that a light path shows to the lens.
#pragma once

#include <cstdint>

namespace abbe {

struct LightDeposit {
    std::uint32_t light = 0, target = 0; // 0: not aimed, else one more than the target's number
    int x = 0, y = 0;                    // pixel
    double luminance = 0; // that one of as many light paths as the frame has pixels brings to the pixel, without weight
    double stands = 1;    // for how many such paths
    double rho = 0;       // how many times as likely one camera path a pixel is to find the same
};

} // namespace abbe
