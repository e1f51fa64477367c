// A figure with its interval.
#pragma once

#include <cmath>
#include <limits>

namespace abbe {

// NaN where unknown.
struct Estimate {
    static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

    static constexpr double kUnbounded = std::numeric_limits<double>::infinity();

    double value = kUnknown;
    double low = kUnknown, high = kUnknown; // of 95 %; high kUnbounded: there is no upper bound

    bool known() const { return !std::isnan(value); }
    bool bounded() const { return !std::isnan(low) && !std::isnan(high); }
};

} // namespace abbe
