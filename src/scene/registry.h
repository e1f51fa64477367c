// The only list of types: every material, texture, light, shape, medium, camera, film and render type that a scene can
// name, with what makes it.
#pragma once

#include "schema/type.h"

namespace abbe {

// All field tables, in the order of the manual. They are made once; this copies them.
schema::TypeTable makeTypeTable();

// The maker of a type, by its kind: MakeMaterial, MakeTexture, MakeCamera, MakePhase, MakeMedium (of media and
// volumes), MakeLight or LoadShape. Requires a type out of the table.
template <typename Make> Make makerOf(const schema::TypeInfo&);

} // namespace abbe
