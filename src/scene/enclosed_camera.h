// Whether the camera stands inside of a body that no light enters: its picture would be black.
#pragma once

#include "render/scene.h"

namespace abbe {

// The material of the body around the camera, or null. It surrounds the camera if every one of 256 directions, spread
// evenly, meets the inner side of one opaque material; and it is dark if neither the camera nor any of the points that
// were met sees a light. A room with a lamp in it is therefore none. Requires: scene.intersector.
const Material* darkBodyAroundCamera(const Scene&);

} // namespace abbe
