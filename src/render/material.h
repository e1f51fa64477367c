// What a surface is made of: makes the Bsdf of a point.
#pragma once

#include "base/arena.h"
#include "render/bsdf.h"
#include "render/effects.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"

namespace abbe {

class Medium;

// Immutable after construction, thread-safe.
class Material {
  public:
    virtual ~Material() = default;
    // Read once, when the scene is built.
    virtual Effects needs() const { return {}; }
    // The scattering at a point; made in the arena. Never null.
    virtual const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept = 0;
    // False if no Bsdf of this material uses uLobe; spares the sampler its dimensions.
    virtual bool choosesLobe() const { return true; }
    // Absorption coefficient inside closed shapes of this material, 1/m; null when clear.
    virtual const Curve* absorption() const { return nullptr; }
    // What fills closed shapes of this material; null for nothing.
    virtual const Medium* interior() const { return nullptr; }
    // True if there is no surface, only the boundary of an interior: light goes straight on.
    virtual bool isBoundary() const { return false; }
};

} // namespace abbe
