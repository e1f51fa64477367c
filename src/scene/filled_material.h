// A material whose shapes are filled with a medium.
#pragma once

#include "render/medium.h"
#include "scene/forwarding_material.h"

namespace abbe {

// Refers to both.
class FilledMaterial final : public ForwardingMaterial {
  public:
    FilledMaterial(const Material& surface, const Medium& interior)
        : ForwardingMaterial(surface), interior_(interior) {}

    Effects needs() const override { return inner_.needs() | interior_.needs(); }
    const Medium* interior() const override { return &interior_; }

  private:
    const Medium& interior_;
};

} // namespace abbe
