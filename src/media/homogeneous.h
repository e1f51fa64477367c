// A medium that is the same everywhere inside its boundary.
#pragma once

#include "media/medium_optics.h"
#include "render/medium.h"

namespace abbe {

// Density 1 everywhere: where it ends is the matter of the shape that it fills.
class HomogeneousMedium final : public Medium {
  public:
    explicit HomogeneousMedium(MediumOptics optics) : optics_(std::move(optics)) {}

    Bounds3 bounds() const override;
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;
    const Curve& extinction() const override { return *optics_.extinction; }
    const Curve& albedo() const override { return *optics_.albedo; }
    const PhaseFunction& phase() const override { return *optics_.phase; }

  private:
    MediumOptics optics_;
};

struct HomogeneousParams : MediumParams {};
schema::TypeInfo homogeneousType();

} // namespace abbe
