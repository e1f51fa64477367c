// What all lights of a scene emit together.
#pragma once

#include "render/light.h"

#include <memory>
#include <span>
#include <vector>

namespace abbe {

// Spectral power in W/nm at each whole nanometre from 360 to 830. Lights that do not tell their spectrum count as even.
// Requires: committed lights.
std::vector<double> emittedSpectrum(std::span<const std::unique_ptr<Light>>);

} // namespace abbe
