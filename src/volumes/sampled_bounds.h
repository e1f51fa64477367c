// Bounds of fields that are known only point by point.
#pragma once

#include "math/bounds.h"
#include "volumes/brick_bounds.h"

namespace abbe {

// A field over index space that anyone can evaluate, but whose extremes over a region nobody knows. Thread-safe.
class PointField {
  public:
    virtual ~PointField() = default;
    // Finite, >= 0.
    virtual float at(Vec3d p) const noexcept = 0;
    // What the field certainly keeps to over a region, however wide; `mean` means nothing. Equal where the field is
    // constant.
    virtual FieldBounds limits(const Bounds3d& region) const = 0;
};

// Of bricks (0, 0, 0) up to `bricks`, from points within them: each brick is sampled in passes until a whole pass
// raises its extremes by next to nothing, as majorants are in progressive null tracking [Misso2023], and the extremes
// found are widened by a margin. Made once and then fixed, in any number of threads with the same result. The field may
// exceed such bounds: estimators that use them must stay unbiased then. Where the limits are not equal the bounds are
// not either, so that nothing escapes for ever.
BrickBounds sampleBounds(const PointField&, Vec3i bricks);

} // namespace abbe
