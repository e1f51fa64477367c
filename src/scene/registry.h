// The only list of types: every material, light, shape, camera, film and render type that a scene can name.
#pragma once

#include "schema/type.h"

namespace abbe {

// All field tables, in the order of the manual.
schema::TypeTable makeTypeTable();

} // namespace abbe
