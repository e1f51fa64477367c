// A relief as a texture.
#pragma once

#include "skin.h"

namespace dragon {

// size × size heights, 0.5 + height / range, row by row with v upwards. Texels beyond seams continue the surface
// there, so that both sides of a seam read the same.
std::vector<float> bake(const Cage& fine, const Skin& skin, int size, double range);

// One channel "Y" of 16-bit numbers.
void writeExr(const char* path, const std::vector<float>& values, int size);

} // namespace dragon
