// A box of mist, smoke or cloud made by noise.
#pragma once

#include "math/transform.h"
#include "media/optical_medium.h"
#include "volumes/brick_bounds.h"
#include "volumes/noise_field.h"

namespace abbe {

// Where the noise is, and what thins it there. The box's own space, m.
struct NoiseBox {
    Vec3d lower, upper;
    double edge = 0;                                              // distance from the faces over which density rises
    double scaleHeight = std::numeric_limits<double>::infinity(); // over which density falls to 1/e
    int up = 1;                                                   // axis along which it falls, from the lower face
};

// Density is the field's, thinned by the box, and 0 outside. Bounds are sampled when it is made; they may be exceeded.
class NoiseVolume final : public OpticalMedium {
  public:
    // Requires an invertible transform and upper > lower.
    NoiseVolume(MediumOptics, const NoisePattern&, const NoiseBox&, const Transform& toRender);

    Bounds3 bounds() const override { return bounds_; }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;

    // In the box's space; what is outside the box is taken as on its faces.
    float density(Vec3d p) const noexcept;
    // Of the brick around such a place.
    FieldBounds boundsAt(Vec3d p) const;
    std::size_t brickCount() const { return bricks_.brickCount(); }

  private:
    class Sampled;
    Vec3d cellsPerMetre() const;

    NoiseField field_;
    NoiseBox box_;
    Vec3i brickCount_;
    BrickBounds bricks_;
    Transform toBox_; // render space to that of the box
    Vec3d margin_;    // beyond the box, for which its bounds hold, too: a thirtieth of a cell
    Bounds3 bounds_;
    float thickest_; // greatest extinction, 1/m
};

} // namespace abbe
