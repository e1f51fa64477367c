// Pictures that are measured, not looked at, are small unless somebody asks for a size.
#pragma once

#include "app/load.h"
#include "scene/build.h"

namespace abbe {

// The frame of the scene, made smaller in proportion until no side is longer than `side` pixels.
Vec2i smallSize(const LoadedScene&, const BuildOptions&, int side);

} // namespace abbe
