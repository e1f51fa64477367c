// The checks one by one: solids that are not closed, are inside out, or overlap; sizes, distances and powers that are
// hardly meant, the traces of a unit that was left out or mistaken.
#pragma once

#include "base/diagnostic.h"
#include "scene/build.h"
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

// W0610: a scene as large as a planet or as small as a bacterium, though no text says so.
void checkExtent(const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0611: a camera from which the scene is a dot.
void checkCameraDistance(const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0612: lamps with the power of power stations.
void checkLampPowers(const BuiltScene&, Diagnostics&);
// W0613: a lens for which all of the scene is out of focus.
void checkFocus(const BuiltScene&, const schema::SceneTree&, Diagnostics&);

} // namespace abbe::checks
