// What paths of light that start at the lights are sent to.
#pragma once

#include "math/vec.h"

#include <vector>

namespace abbe {

// A ball about something that focuses light, for all the time that the shutter is open. Render space, m. From far away
// one that is larger than the scene's counts as that.
struct AimTarget {
    Vec3 centre;
    float radius = 0; // > 0
};

// Frozen before light is gathered: densities must not depend on what they are used for. All numbers are relative,
// finite and >= 0. The density of a direction looks at every target: whoever makes them groups what is many.
struct EmissionPlan {
    std::vector<AimTarget> targets;
    // How useful a watt of each light is; empty: all alike. No path starts at a light of 0.
    std::vector<double> usefulness;
    // How useful each target is: a row for all lights, or a row for each, one after the other; empty: all alike. A row
    // of zeros aims at nothing.
    std::vector<double> aim;
    // Where in each target's cone or disk it is: for each entry of `aim` the weights of the cells of an AimGrid, > 0,
    // as many rows as columns, or none for all alike; empty: all of them alike.
    std::vector<std::vector<double>> parts = {};
    // Of the paths of each light, those that take its own directions and, from far away, the whole scene: so that no
    // light is ever missed. In (0, 1].
    float uniformShare = 0.25f;
};

} // namespace abbe
