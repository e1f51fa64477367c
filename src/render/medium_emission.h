// Light that a medium gives off by itself: flame, glowing gas.
#pragma once

#include "render/ray.h"
#include "render/walk_space.h"
#include "spectrum/spectrum.h"

namespace abbe {

// One ray through what shines.
class EmissionWalk {
  public:
    // The next segment in which there may be emission, as MediumWalk::next(); `mean` is that of a relative amount.
    virtual bool next(MediumSegment&) noexcept = 0;
    // Radiance that a metre of the way adds, at a distance along the ray within the last segment: W·m⁻³·sr⁻¹·nm⁻¹.
    virtual Spectrum emitted(float t, const Wavelengths&) noexcept = 0;

  protected:
    ~EmissionWalk() = default; // as MediumWalk
};

// Immutable, thread-safe, render space. A Light may know how to sample it (Light::emission()).
class MediumEmission {
  public:
    virtual ~MediumEmission() = default;
    // Null if the ray meets nothing that shines before tMax (which may be infinite).
    virtual EmissionWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept = 0;
    // LightSample::pdfSolidAngle of the sample that its light makes of point `p` seen from `from`; 0 if it has no
    // light. Volumes have a density per m³, p_V; with a characteristic length ℓ, the same for all points, a sample
    // states p_V r² ℓ as its density over directions and ε ℓ as its radiance. Any ℓ is right, since the weights of the
    // two techniques need only add up to 1; near the way through a piece of the field it makes them balance.
    virtual float pdfSolidAngle(Vec3 from, Vec3 p) const noexcept = 0;
};

} // namespace abbe
