// What a surface is made of: makes the Bsdf of a point.
// What light passes on its way out of a surface that gives it off: a coat, fuzz.
#pragma once

#include "base/arena.h"
#include "render/bsdf.h"
#include "render/effects.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

namespace abbe {

// Immutable, thread-safe; the same all over the surface.
class EmissionVeil {
  public:
    virtual ~EmissionVeil() = default;
    // Share, 0 … 1, of the light that leaves at an angle of this cosine in [0, 1] to the geometric normal.
    virtual Spectrum passing(float cosine, const Wavelengths&) const noexcept = 0;
};

class EmissionVeil;
class Medium;
class Texture;

// What a surface gives off by itself, on its outer side.
struct SurfaceEmission {
    double luminance = 0;               // cd/m², where `texture` and the Y of `color` are 1; 0: none
    const Curve* color = nullptr;       // null: D65 of Y = 1
    const Texture* texture = nullptr;   // factor over the surface; null: 1
    bool bothSides = false;             // on its inner side, too
    const EmissionVeil* veil = nullptr; // not in the luminance; null: none
};

// Immutable after construction, thread-safe.
class Material {
  public:
    virtual ~Material() = default;
    // Read once, when the scene is built. Effect::textures need not be named: it follows from usesTextures().
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

    // True if no light gets through the surface, from either side.
    virtual bool isOpaque() const { return false; }

    // False if light and eye meet it in different places: hair, whose fibres are met on the near side, whatever goes
    // through them. Light paths end there, and camera paths have all that it scatters.
    virtual bool reversible() const { return true; }

    // False if light of a narrow beam is spread over all directions by whatever scatters it here: what cannot focus it
    // is nothing to aim paths of light at.
    virtual bool focuses() const { return reversible(); }

    // Whether bsdf(), opacity() or bend() look at the parametrisation of the hit (SurfaceHit::dpdu and after).
    virtual bool usesTextures() const { return false; }
    // Whether bend() changes anything. It is then called before bsdf(), to turn hit.shading; hit.shading.z stays in the
    // hemisphere of ng.
    virtual bool bends() const { return false; }
    virtual void bend(SurfaceHit&) const noexcept {}
    // Whether opacity() may be below 1. That share of the light meets the surface; the rest goes straight on.
    virtual bool mayBeOpen() const { return false; }
    virtual float opacity(const SurfaceHit&) const noexcept { return 1; }
    // Refractive index of the inside; null if light does not refract into it. Where shapes overlap, the one of higher
    // priority fills the space; among equals the one entered later.
    virtual const Curve* ior() const { return nullptr; }
    virtual int priority() const { return 0; }
    // Whether bsdf() looks at SurfaceHit::outside: the surface looks otherwise in water.
    virtual bool seesOutside() const { return ior() != nullptr; }
    // Read once, when the scene is built.
    virtual SurfaceEmission emission() const { return {}; }
};

} // namespace abbe
