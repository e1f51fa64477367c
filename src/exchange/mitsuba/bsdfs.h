// BSDFs of Mitsuba's as materials.
#pragma once

#include "exchange/mitsuba/textures.h"

namespace abbe::exchange {

// The name of the material that a BSDF becomes, defined once, with what its shapes must know.
const std::pair<std::string, MaterialTraits>& materialOf(const XmlObject& bsdf, MitsubaContext&);

// Appends type and properties of a material to `at`.
void writeMaterial(SceneNode& at, const XmlObject& bsdf, MaterialTraits&, MitsubaContext&);

// principled, principledthin, hair (bsdf_principled.cpp).
void writePrincipled(SceneNode& at, const XmlObject& bsdf, bool thin, MaterialTraits&, MitsubaContext&);
void writeHair(SceneNode& at, const XmlObject& bsdf, MitsubaContext&);

// `roughness` and `anisotropy` (with their prefix) of alpha, alpha_u and alpha_v. Returns whether the highlight is
// stretched along v, which only some materials can be told.
bool writeRoughness(SceneNode& at, const XmlObject& bsdf, std::string_view prefix, MaterialTraits&, MitsubaContext&);

// The index inside over that outside (bsdf_indices.cpp).
double relativeIndex(const XmlObject& bsdf, double defaultInside, MitsubaContext&);
// `index` of a conductor, or a metal's in `property`.
void writeMetalIndex(SceneNode& at, std::string property, const XmlObject& bsdf, MitsubaContext&);

} // namespace abbe::exchange
