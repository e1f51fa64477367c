// How checks of whole scenes name things and say where they are.
#pragma once

#include "math/vec.h"
#include "scene/build.h"

#include <string>

namespace abbe::checks {

// "3.2 m", "12 km", "45 um": three digits in the unit that suits.
std::string lengthText(double metres);
// "0.1 2 -3.5": a point of render space as a scene states it, in the unit of the header.
std::string pointText(Vec3 p, const BuiltScene&, const schema::Header&);
// What the file calls a shape or a light, in backticks.
std::string quotedName(const void* thing, const BuiltScene&);
Span placeOf(const void* thing, const BuiltScene&);

} // namespace abbe::checks
