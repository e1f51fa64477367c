// What must hold of a cage before it may be subdivided.
#pragma once

#include "math/mesh_data.h"

#include <optional>
#include <string>

namespace abbe {

// The first fault of a cage, naming the face, vertex, crease or corner (from 0); nothing for a sound one. Checked are
// index ranges, sizes of lists, faces of fewer than three or with repeated corners, faces that are no triangles under
// Loop, creases that are no edge of a face, numbers that are not finite or so large that squares overflow, negative
// sharpnesses, creases where two faces lie back to back, and the valence limits of the library underneath (65535).
// Faces in any other arrangement are sound: flipped, doubled, three at an edge.
std::optional<std::string> findFault(const SubdivisionCage&);

} // namespace abbe
