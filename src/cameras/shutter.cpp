#include "cameras/shutter.h"

#include <algorithm>
#include <cmath>

namespace abbe {

double Shutter::position(double u) const {
    // In units of the exposure: area 1 under a trapezoid of height 1.
    const double length = 1 + 0.5 * (opening + closing);
    double t;
    if (u < 0.5 * opening)
        t = std::sqrt(2 * u * opening);
    else if (1 - u < 0.5 * closing)
        t = length - std::sqrt(2 * (1 - u) * closing);
    else
        t = u + 0.5 * opening;
    return std::clamp(t / length, 0.0, 1.0);
}

} // namespace abbe
