// A material that is another one, but for what its heirs change.
#pragma once

#include "render/material.h"

namespace abbe {

// Refers to it.
class ForwardingMaterial : public Material {
  public:
    explicit ForwardingMaterial(const Material& inner) : inner_(inner) {}

    Effects needs() const override { return inner_.needs(); }
    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return inner_.bsdf(hit, lambda, arena);
    }
    bool choosesLobe() const override { return inner_.choosesLobe(); }
    const Curve* absorption() const override { return inner_.absorption(); }
    const Medium* interior() const override { return inner_.interior(); }
    bool isBoundary() const override { return inner_.isBoundary(); }
    bool isOpaque() const override { return inner_.isOpaque(); }
    bool reversible() const override { return inner_.reversible(); }
    bool focuses() const override { return inner_.focuses(); }
    bool usesTextures() const override { return inner_.usesTextures(); }
    bool bends() const override { return inner_.bends(); }
    void bend(SurfaceHit& hit) const noexcept override { inner_.bend(hit); }
    bool mayBeOpen() const override { return inner_.mayBeOpen(); }
    float opacity(const SurfaceHit& hit) const noexcept override { return inner_.opacity(hit); }
    const Curve* ior() const override { return inner_.ior(); }
    int priority() const override { return inner_.priority(); }
    bool seesOutside() const override { return inner_.seesOutside(); }
    SurfaceEmission emission() const override { return inner_.emission(); }

  protected:
    const Material& inner_;
};

} // namespace abbe
