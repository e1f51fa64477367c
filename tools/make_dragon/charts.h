// Texture coordinates by projecting pieces of a cage along a few directions: real seams between the pieces.
#pragma once

#include "cage.h"

namespace dragon {

// Fills cage.uvs, between 0 and 1, with `margin` around every chart. Returns the number of charts.
int makeCharts(Cage& cage, double margin);

} // namespace dragon
