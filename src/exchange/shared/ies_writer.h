// Lights that throw a picture: their intensity by direction as a photometric file, the one kind of light that has any.
#pragma once

#include "math/vec.h"

#include <functional>
#include <string>

namespace abbe::exchange {

// A file (IES LM-63, type C) in steps of half a degree. `candela` gives the intensity in a unit direction of the world,
// for a light whose direction, turn and transform are not stated. Empty where all is dark.
std::string iesFile(const std::function<double(Vec3d)>& candela);

} // namespace abbe::exchange
