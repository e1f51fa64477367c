// What the cones of the eye answer to a colour, as models of chromatic adaptation have it.
#pragma once

#include "spectrum/color_space.h"

namespace abbe {

// In the space in which adaptation() scales. Colours far from any white, those of single lines for example, have
// responses of 0 or below.
Vec3d coneResponse(const Xyz&, ConeModel = ConeModel::bradford);

} // namespace abbe
