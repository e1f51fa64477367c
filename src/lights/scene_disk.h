// The cross-section that the finite geometry offers to light from far away.
#pragma once

#include "math/bounds.h"

namespace abbe {

// m². Scenes without finite geometry (planes alone) get that of a sphere of 1 m, so that no distant light counts for
// nothing.
inline double sceneDiskArea(const Bounds3& bounds) {
    const double radius = bounds.empty() ? 0 : bounds.radius();
    return kPiD * (radius > 0 && std::isfinite(radius) ? square(radius) : 1);
}

} // namespace abbe
