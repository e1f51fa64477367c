// What all media of the language share: the optics of their collisions.
#pragma once

#include "media/medium_optics.h"
#include "render/medium.h"

namespace abbe {

// Leaves to its heirs where the medium is and how dense.
class OpticalMedium : public Medium {
  public:
    const Curve& extinction() const final { return *optics_.extinction; }
    const Curve& albedo() const final { return *optics_.albedo; }
    const PhaseFunction& phase() const final { return *optics_.phase; }

  protected:
    explicit OpticalMedium(MediumOptics optics) : optics_(std::move(optics)) {}
    void replaceExtinction(std::shared_ptr<const Curve> curve) {
        optics_.extinction = curve.get();
        optics_.own.push_back(std::move(curve));
    }

  private:
    MediumOptics optics_;
};

} // namespace abbe
