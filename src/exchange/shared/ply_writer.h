// Meshes as binary PLY, for what a foreign scene states in its own text or in a format that scenes do not read.
#pragma once

#include "math/mesh_data.h"

#include <string>

namespace abbe::exchange {

// Little-endian PLY with x y z, nx ny nz, u v and attributes as float properties (one channel by its name, three as
// name_r, name_g, name_b, `color` as red, green, blue) and all faces. Requires indices in range.
std::string binaryPly(const MeshData&);

} // namespace abbe::exchange
