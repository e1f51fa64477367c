// Sizes, distances and powers that are hardly meant: the traces of a unit that was left out or mistaken.
#pragma once

#include "base/diagnostic.h"
#include "scene/build.h"
#include "schema/scene_tree.h"

namespace abbe::checks {

// W0610: a scene as large as a planet or as small as a bacterium, though no text says so.
void checkExtent(const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0611: a camera from which the scene is a dot.
void checkCameraDistance(const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0612: lamps with the power of power stations.
void checkLampPowers(const BuiltScene&, Diagnostics&);
// W0613: a lens for which all of the scene is out of focus.
void checkFocus(const BuiltScene&, const schema::SceneTree&, Diagnostics&);

} // namespace abbe::checks
