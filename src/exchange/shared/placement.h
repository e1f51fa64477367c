// Where things are, in the words of a scene.
#pragma once

#include "exchange/shared/scene_node.h"
#include "math/transform.h"

namespace abbe::exchange {

bool isIdentity(const Transform&);
// Where the axes and the origin of a thing go.
Transform axesTo(Vec3d x, Vec3d y, Vec3d z, Vec3d origin = {});
// Fills `transform { … }` with a map, as plain steps where it is that plain; nothing where it is the identity.
void writeTransform(SceneNode& parent, const Transform&);
// Steps alone, of a transform or of a key of one; `matrix` and the like. At least one.
void writeSteps(SceneNode& transform, const Transform&);

} // namespace abbe::exchange
