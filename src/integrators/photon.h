// A vertex of a light path that waits to be met by camera paths.
#pragma once

#include "math/vec.h"
#include "render/light.h"
#include "spectrum/spectrum.h"

#include <cstdint>

namespace abbe {

class Medium;

// Light that arrives at a surface, or is scattered in a medium, after a mirror or clear glass was the first thing it
// met [Jensen1996].
struct Photon {
    Vec3 p;                         // render space
    Vec3 wi;                        // unit, against its flight
    Vec3 ng;                        // geometric normal of the surface, outside; 0 in a medium
    Spectrum flux;                  // W·nm⁻¹ over the density of all before, at the wavelengths of the round
    Spectrum densities;             // as SpectralDensities::unidirectional, by which sums are divided in the mean
    const Medium* medium = nullptr; // that scatters it; null: a surface
    const Light* light = nullptr;   // where it began,
    std::uint32_t target = 0;       // sent to what: as in EmittedRay,
    Vec2 aim;                       // and where in that
    float cameraOdds = 0;       // density of the camera paths that come from the lamp here, without the scattering at
                                // p, over that of the light paths; 0: there are none
    std::uint32_t vertices = 0; // at which it was scattered on the way
    bool heroOnly = false;      // `flux` and densities are those of the first lane, eight times
    bool followed = false;      // by a chain that manifold sampling covers, if p is asked for it
    std::uint8_t axis = 0;      // PhotonMap's own
};

} // namespace abbe
