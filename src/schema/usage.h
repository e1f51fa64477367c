// Checks of a whole file after all its definitions are known.
#pragma once

#include "schema/scene_tree.h"

namespace abbe::schema {

// Names are unique per kind. Requires: tree.index is filled.
void checkNames(const SceneTree&, const TypeTable&, Diagnostics&);

// Instances place existing objects, no object contains itself, and nothing is defined in vain (a warning, given only
// when no error could have caused it).
void checkUsage(const SceneTree&, Diagnostics&);

} // namespace abbe::schema
