// Moves that a person makes with a camera, as motions of a hand: around what it looks at, along the picture, nearer and
// farther, through the scene. The upright direction stays, so that no series of moves tilts the horizon.
#pragma once

#include "cameras/camera_params.h"

#include <string>

namespace abbe {

// Around what it looks at, rad: x to the right of what is seen, y upwards. Ends short of looking along `up`.
CameraPose orbited(const CameraPose&, Vec2d radians);
// The same around the camera: what it looks at moves, x to the right, y upwards.
CameraPose lookedAround(const CameraPose&, Vec2d radians);
// Camera and look-at by so much of the picture's height, which is `height` m where it looks at: x to the right, y
// upwards.
CameraPose panned(const CameraPose&, Vec2d heights, double height);
// To `factor` times the distance from what it looks at; what a parallel camera shows grows with it. Requires factor >
// 0.
CameraPose dollied(const CameraPose&, double factor);
// Camera and look-at, to the right, upwards and ahead, in units of the distance between them.
CameraPose flown(const CameraPose&, Vec3d shares);

// Properties of a camera that stands so, a line each, in a scene whose bare lengths are of `unit` m: "from 0 1 4". As
// many digits as the picture can tell. `upright`: the scene's own, which needs no line.
std::string poseLines(const CameraPose&, double unit, Vec3d upright);

} // namespace abbe
