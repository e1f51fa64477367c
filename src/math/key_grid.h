// Keys at any times, put onto equally spaced ones, as acceleration structures want them.
#pragma once

#include "math/interval.h"

#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

// A state between key `key` and the next one: 0 is the key itself, and the only fraction of the last.
struct KeyPosition {
    std::size_t key = 0;
    double fraction = 0;

    friend bool operator==(const KeyPosition&, const KeyPosition&) = default;
};

// Where `time` lies among the keys; before the first and after the last these hold. Requires increasing times.
KeyPosition keyPosition(std::span<const double> times, double time);

// Linear interpolation between equally spaced steps in place of linear interpolation between keys.
struct KeyGrid {
    // A key that is no step: it is replaced by what lies between this step and the next.
    struct Between {
        std::size_t key = 0, step = 0;
        double fraction = 0;
    };
    std::vector<KeyPosition> steps; // the first when the interval begins, the last when it ends; one if nothing changes
    std::vector<Between> offGrid;   // empty: the grid says the same as the keys
};

// As few steps as hold all keys of the interval exactly; `maxSteps`, at least 2, if there are none so few.
// Requires increasing times and a duration >= 0.
KeyGrid makeKeyGrid(std::span<const double> times, Interval, std::size_t maxSteps);

} // namespace abbe
