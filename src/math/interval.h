// A span of time.
#pragma once

namespace abbe {

// A span of time, in s.
struct Interval {
    double open = 0, duration = 0;

    double at(double position) const { return open + position * duration; } // position in [0, 1]
};

} // namespace abbe
