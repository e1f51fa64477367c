// Air and fog: everywhere, thinner with height.
#pragma once

#include "media/medium_optics.h"

namespace abbe {

struct AtmosphereParams : MediumParams {
    double scaleHeight = std::numeric_limits<double>::infinity(); // m, over which density falls to 1/e
    double ground = 0;                                            // m, world height below which density is 1
};

// Density 1 up to the ground, then e^(-height / scaleHeight). An infinite scale height is the same fog everywhere.
class Atmosphere final : public OpticalMedium {
  public:
    // `ground`: height of the ground above the origin of render space along the unit vector `up`.
    Atmosphere(MediumOptics, Vec3 up, double ground, double scaleHeight);

    Bounds3 bounds() const override;
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;

  private:
    Vec3 up_;
    double ground_, scaleHeight_;
};

schema::TypeInfo atmosphereType();

} // namespace abbe
