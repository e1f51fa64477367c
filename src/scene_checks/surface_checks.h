// Solids that are not closed, are inside out, or overlap.
#pragma once

#include "scene_checks/solids.h"
#include "schema/scene_tree.h"

#include <cstdint>
#include <vector>

namespace abbe::checks {

// The shapes into which light refracts, with their faces read.
std::vector<Solid> refractingSolids(const BuiltScene&);

// W0605, W0606. Notes which of them are no sound solids.
void checkSurfaces(std::vector<Solid>&, const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0607: closed shapes that emit inwards alone.
void checkEmittingSides(const BuiltScene&, Diagnostics&);

// Lines that all pairs of solids are tried with together, and pairs at most; more are left out.
inline constexpr std::uint32_t kMostOverlapLines = 1u << 20, kMostOverlapPairs = 1u << 14;
// W0608. Requires checkSurfaces(). Solids of one index and colour are one solid, whatever their number.
void checkOverlaps(const std::vector<Solid>&, const BuiltScene&, const schema::SceneTree&, Diagnostics&);

// W0609, for solids; returns whether the camera is inside of something opaque.
bool checkAroundCamera(const std::vector<Solid>&, const BuiltScene&, Diagnostics&);

} // namespace abbe::checks
