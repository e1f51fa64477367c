// A figure with its interval.
#pragma once

#include <cmath>
#include <limits>

namespace abbe {

// NaN where unknown.
struct Estimate {
    static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

    double value = kUnknown;
    double low = kUnknown, high = kUnknown; // of 95 %

    bool known() const { return !std::isnan(value); }
    bool bounded() const { return !std::isnan(low) && !std::isnan(high); }
};

} // namespace abbe
