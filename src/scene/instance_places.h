// Where definitions `instances` put their objects, for who writes a scene down instead of rendering it.
#pragma once

#include "math/transform.h"
#include "schema/scene_tree.h"
#include "schema/type.h"

#include <map>
#include <vector>

namespace abbe {

// The places of each definition, in order, each without the definition's own transform: those that a render has, since
// they come from the same builder.
using InstancePlaces = std::map<const schema::Definition*, std::vector<Transform>>;

// Builds the scene without its geometry, when the shutter opens. Requires a scene that can be built without errors; of
// another one places may be missing. Never throws.
InstancePlaces findInstancePlaces(const schema::SceneTree&, const schema::TypeTable&);

} // namespace abbe
