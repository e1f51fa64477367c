// What was found out about small images of lamps in mirrors and glass before a render, for people to read.
#pragma once

#include <cstdint>

namespace abbe {

// It depends on the scene, the frame, the pixel filter and the seed alone.
struct GlintFindings {
    bool measured = false;   // a pilot has run
    std::uint32_t found = 0; // glints that are probed
    double error = 0; // of the worst tile of 8×8 pixels, as 1024 samples by camera paths alone would leave it, relative
    double rays = 0;  // of probes for a sample of every pixel, in the mean over pixels
    std::uint64_t pilotRays = 0; // that it took to find out
};

} // namespace abbe
