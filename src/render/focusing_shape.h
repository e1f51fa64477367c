// What light paths are sent to.
#pragma once

#include "math/bounds.h"

#include <string>

namespace abbe {

// A shape whose material focuses light (Material::focuses()).
struct FocusingShape {
    Bounds3 box;      // for all the time that the shutter is open, m, render space; infinite where it is not known
    std::string name; // as in Scene::names
};

} // namespace abbe
