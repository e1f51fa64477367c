// What fills solids with an OpenPBR surface: the medium of their subsurface part, or of scattering glass.
#pragma once

#include "materials/openpbr.h"
#include "materials/subsurface_albedo.h"

#include <optional>

namespace abbe {

// Whether light goes in and out through the matte part of the surface of a solid.
bool hasSubsurfaceInside(const OpenPbrParams&);
// Whether light refracts into the solid.
bool mayRefract(const OpenPbrParams&);
// Whether its clear part leads into a medium that scatters, which then absorbs, too.
bool hasScatteringGlass(const OpenPbrParams&);

// The medium of either; nothing if there is none. The curves of the parameters must outlive it. Requires parameters
// that checkParams() has found right: there are never both.
std::optional<SubsurfaceInside> insideOf(const OpenPbrParams&);

} // namespace abbe
