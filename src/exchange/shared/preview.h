// What shows a model that comes without a camera or without lights: its format has none, or its author wrote none.
#pragma once

#include "exchange/shared/scene_node.h"
#include "math/bounds.h"

#include <vector>

namespace abbe::exchange {

// A picture of the proportions that previewCamera() frames for.
SceneNode previewFilm();

// A camera that looks from the front (+z), a little from the right and from above, at all of a box in metres with y up:
// the box fills the frame of previewFilm() but for a margin. An empty box counts as one of 1 m about the origin, a
// point as a box of 1 m about it.
SceneNode previewCamera(const Bounds3d&);

// An even sky that is seen as a grey background, and a large soft key light from above the camera's left, both of
// neutral white. They suit a camera without an exposure: white of 80 % that faces the key light renders as 0.72.
std::vector<SceneNode> previewLights();

} // namespace abbe::exchange
