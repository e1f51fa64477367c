// A material whose shapes are filled with a medium.
#pragma once

#include "render/material.h"
#include "render/medium.h"

namespace abbe {

// Refers to both.
class FilledMaterial final : public Material {
  public:
    FilledMaterial(const Material& surface, const Medium& interior) : surface_(surface), interior_(interior) {}

    Effects needs() const override { return surface_.needs() | interior_.needs(); }
    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return surface_.bsdf(hit, lambda, arena);
    }
    bool choosesLobe() const override { return surface_.choosesLobe(); }
    const Curve* absorption() const override { return surface_.absorption(); }
    const Medium* interior() const override { return &interior_; }
    bool isBoundary() const override { return surface_.isBoundary(); }

  private:
    const Material& surface_;
    const Medium& interior_;
};

} // namespace abbe
