// Media and phase functions of Mitsuba's.
#pragma once

#include "exchange/mitsuba/textures.h"

namespace abbe::exchange {

// The name of a medium, defined once; empty where it is left out, with a place for the reason.
std::string mediumOf(const XmlObject& medium, Span from, MitsubaContext&);
// The name of the medium inside a shape, defined once; empty without one, or where it is left out.
std::string interiorOf(const XmlObject& shape, MitsubaContext&);

// The medium inside a shape as a volume of its own, where it is one of voxels: `volume NAME vdb …`; null otherwise. It
// fills the bounds of its grid (grid_media.cpp).
const SceneNode* gridVolumeOf(const XmlObject& shape, MitsubaContext&);
// The mean of a grid that stands where nothing varies from place to place, which is said.
double meanOfGrid(const XmlObject& volume, MitsubaContext&);
void writePhase(SceneNode& at, const XmlObject& phase, int depth, MitsubaContext&);
// The value of a parameter that is no grid; null for grids.
const XmlParam* constantOf(const XmlParam*);

} // namespace abbe::exchange
