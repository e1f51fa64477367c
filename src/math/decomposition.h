// An affine map taken apart for interpolation: matrices mixed entry by entry shear and shrink what they turn.
#pragma once

#include "math/transform.h"

#include <array>

namespace abbe {

// A unit quaternion w + xi + yj + zk.
struct Quaternion {
    double w = 1;
    Vec3d v{};
};

// A = R S: a rotation after a stretch. S is symmetric; a mirror makes all of S negative, so that R always is a proper
// rotation [Shoemake1992]. Requires an invertible map.
struct Decomposition {
    Vec3d translation;
    Quaternion rotation;
    std::array<std::array<double, 3>, 3> stretch{};

    static Decomposition of(const Transform&);
    Transform compose() const;
};

// Translation and stretch linearly, rotation along the shorter arc at constant speed [Shoemake1985]. u in [0, 1].
Decomposition interpolate(const Decomposition&, const Decomposition&, double u);

} // namespace abbe
