// When light comes in.
#pragma once

namespace abbe {

// Transmission over time: a ramp up, a plateau, a ramp down. `exposure` is the time of a sudden shutter that lets in as
// much light, which is what cameras state; ramps make the whole longer.
struct Shutter {
    double open = 0;     // s, when it begins to open
    double exposure = 0; // s, >= 0
    double opening = 0;  // length of the ramps, in units of the exposure; opening + closing <= 2
    double closing = 0;

    double duration() const { return exposure * (1 + 0.5 * (opening + closing)); } // from first to last light
    // Where u in [0, 1) falls in the interval, in [0, 1], with the density of the transmission: its inverse cumulative
    // distribution.
    double position(double u) const;
    double timeAt(double position) const { return open + position * duration(); } // s
};

} // namespace abbe
