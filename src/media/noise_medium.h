// Noise without an end: what fills a shape, or all of space.
#pragma once

#include "math/transform.h"
#include "media/optical_medium.h"
#include "volumes/noise_field.h"

namespace abbe {

// Density is the field's, everywhere. The only bounds are those of the pattern, so that thin patterns cost lookups.
class NoiseMedium final : public OpticalMedium {
  public:
    // Requires an invertible transform, from the pattern's space to the world.
    NoiseMedium(MediumOptics, const NoisePattern&, const Transform& toWorld);
    // To be called before the first walk: where the origin of render space is in the world.
    void setOrigin(Vec3d origin) { origin_ = origin; }

    Bounds3 bounds() const override;
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;

  private:
    NoiseField field_;
    Transform toPattern_; // from the world
    Vec3d origin_;
};

} // namespace abbe
