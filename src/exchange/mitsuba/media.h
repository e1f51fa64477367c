// Media and phase functions of Mitsuba's.
#pragma once

#include "exchange/mitsuba/textures.h"

namespace abbe::exchange {

// The name of a medium, defined once; empty where it is left out, with a place for the reason.
std::string mediumOf(const XmlObject& medium, Span from, MitsubaContext&);
// What a shape says of the media inside of it and around it; null for none, and for all where the integrator sees none,
// which is said.
struct ShapeMedia {
    const XmlObject *inside = nullptr, *outside = nullptr;
    bool isStated() const { return inside || outside; }
};
ShapeMedia mediaOf(const XmlObject& shape, MitsubaContext&);
// Whether what is around a shape is there without it: the medium of the sensor, or one that fills another shape.
bool isAround(const XmlObject* medium, MitsubaContext&);
// After all shapes: the medium around the camera, and what media of shapes are not as they are stated.
void placeMedia(MitsubaContext&);

// The medium inside a shape as a volume of its own, where it is one of voxels: `volume NAME vdb …`; null otherwise. It
// fills the bounds of its grid (grid_media.cpp).
const SceneNode* gridVolumeOf(const XmlObject& shape, MitsubaContext&);
// The mean of a grid that stands where nothing varies from place to place, which is said.
double meanOfGrid(const XmlObject& volume, MitsubaContext&);
void writePhase(SceneNode& at, const XmlObject& phase, int depth, MitsubaContext&);
// The value of a parameter that is no grid; null for grids.
const XmlParam* constantOf(const XmlParam*);

} // namespace abbe::exchange
