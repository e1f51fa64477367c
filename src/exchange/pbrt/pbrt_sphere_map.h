// The equal-area octahedral map of the sphere onto the unit square, which pbrt's images all around have
// [Clarberg2008; Pharr2023, sec. 3.8.3].
#pragma once

#include "io/image.h"
#include "math/vec.h"

namespace abbe::exchange {

// Of a unit vector; z is up, (0.5, 0.5) in the middle of the square.
Vec2d pbrtSphereToSquare(Vec3d direction);
Vec3d pbrtSquareToSphere(Vec2d square);
// Bilinear between the middles of the pixels; beyond an edge the map goes on at the mirrored place of the same edge.
Vec3d pbrtOctahedralLookup(const RgbImage&, Vec2d square);

} // namespace abbe::exchange
