// A medium that is the same everywhere inside its boundary.
#pragma once

#include "media/glow.h"
#include "media/medium_optics.h"
#include "render/medium.h"

namespace abbe {

// Density 1 everywhere: where it ends is the matter of the shape that it fills. What it gives off is found along rays
// only: no light samples it.
class HomogeneousMedium final : public OpticalMedium {
  public:
    // Emits with a glow; `kelvin` is its temperature, if the glow asks for one. Its curves must outlive the medium.
    explicit HomogeneousMedium(MediumOptics, std::optional<Glow> = {}, double kelvin = 0);

    // Before anyone looks: it is to be no denser than this, 1/m. Requires that it does not emit.
    void limitExtinction(double most);

    Bounds3 bounds() const override;
    bool homogeneous() const override { return true; }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;
    const MediumEmission* emission() const override { return emission_ ? &*emission_ : nullptr; }

  private:
    class Emission final : public MediumEmission {
      public:
        Emission(const Glow& glow, float kelvin) : glow_(glow), kelvin_(kelvin) {}
        // Null for rays that nothing ends: no sum of light along them is finite.
        EmissionWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;
        float pdfSolidAngle(Vec3, Vec3) const noexcept override { return 0; }

      private:
        Glow glow_;
        float kelvin_;
    };

    std::optional<Emission> emission_;
};

struct HomogeneousParams : MediumParams, GlowParams {
    double temperature = 0; // K; 0: does not emit by it
};
schema::TypeInfo homogeneousType();

} // namespace abbe
