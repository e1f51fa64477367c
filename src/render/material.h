// What a surface is made of: makes the Bsdf of a point, and says what holds all over the surface.
#pragma once

#include "base/arena.h"
#include "render/bsdf.h"
#include "render/effects.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

namespace abbe {

class Medium;
class Texture;

// What light passes on its way out of a surface that gives it off: a coat, fuzz. Immutable, thread-safe; the same all
// over the surface.
class EmissionVeil {
  public:
    virtual ~EmissionVeil() = default;
    // Share, 0 … 1, of the light that leaves at an angle of this cosine in [0, 1] to the geometric normal.
    virtual Spectrum passing(float cosine, const Wavelengths&) const noexcept = 0;
};

// What a surface gives off by itself, on its outer side.
struct SurfaceEmission {
    double luminance = 0;               // cd/m², where `texture` and the Y of `color` are 1; 0: none
    const Curve* color = nullptr;       // null: D65 of Y = 1
    const Texture* texture = nullptr;   // factor over the surface; null: 1
    bool bothSides = false;             // on its inner side, too
    const EmissionVeil* veil = nullptr; // not in the luminance; null: none
};

// How light hits a material: fixed when it is made, and the same all over the surface.
struct MaterialTraits {
    // Read once, when the scene is built. Effect::textures need not be named: it follows from usesTextures.
    Effects needs = {};
    // False if no Bsdf of this material uses uLobe; spares the sampler its dimensions.
    bool choosesLobe = true;
    // True if there is no surface, only the boundary of an interior: light goes straight on.
    bool isBoundary = false;
    // True if no light gets through the surface, from either side.
    bool isOpaque = false;
    // False if light and eye hit it in different places: hair, whose fibres are hit on the near side, whatever goes
    // through them. Light paths end there, and camera paths have all that it scatters.
    bool reversible = true;
    // False if light of a narrow beam is spread over all directions by whatever scatters it here: what cannot focus it
    // is nothing to aim paths of light at. Nor, as a rule, is what is not reversible.
    bool focuses = true;
    // Whether bsdf(), opacity() or bend() look at the parametrisation of the hit (SurfaceHit::dpdu and after).
    bool usesTextures = false;
    // Whether bend() changes anything, or bsdf() asks for SurfaceHit::arrival.
    bool bends = false;
    // Whether opacity() may be below 1.
    bool mayBeOpen = false;
    // Whether bsdf() looks at SurfaceHit::outside: the surface looks otherwise in water. Whatever has an ior does.
    bool seesOutside = false;
};

// What fills closed shapes of a material: fixed as its traits are. What it points to lives as long as the material.
struct MaterialInside {
    const Curve* absorption = nullptr; // coefficient, 1/m; null when clear
    const Medium* interior = nullptr;  // null for nothing
    const Curve* ior = nullptr;        // refractive index; null if light does not refract into it
    // Where shapes overlap, the one of higher priority fills the space; among equals the one entered later.
    int priority = 0;
};

// Immutable after construction, thread-safe. Stays where it was made: traits may point to members.
class Material {
  public:
    virtual ~Material() = default;
    Material(const Material&) = delete;
    Material& operator=(const Material&) = delete;

    // The scattering at a point; made in the arena. Never null.
    virtual const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept = 0;
    // Changes nothing unless bends(). Called before bsdf(), to turn hit.shading; hit.shading.z stays in the hemisphere
    // of ng.
    virtual void bend(SurfaceHit&) const noexcept {}
    // Share of the light that hits the surface, 1 unless mayBeOpen(); the rest goes straight on.
    virtual float opacity(const SurfaceHit&) const noexcept { return 1; }
    // Read once, when the scene is built.
    virtual SurfaceEmission emission() const { return {}; }

    const MaterialTraits& traits() const { return traits_; }
    Effects needs() const { return traits_.needs; }
    bool choosesLobe() const { return traits_.choosesLobe; }
    bool isBoundary() const { return traits_.isBoundary; }
    bool isOpaque() const { return traits_.isOpaque; }
    bool reversible() const { return traits_.reversible; }
    bool focuses() const { return traits_.focuses; }
    bool usesTextures() const { return traits_.usesTextures; }
    bool bends() const { return traits_.bends; }
    bool mayBeOpen() const { return traits_.mayBeOpen; }
    bool seesOutside() const { return traits_.seesOutside; }

    const MaterialInside& inside() const { return inside_; }
    const Curve* absorption() const { return inside_.absorption; }
    const Medium* interior() const { return inside_.interior; }
    const Curve* ior() const { return inside_.ior; }
    int priority() const { return inside_.priority; }

  protected:
    Material() = default;

    // Set in the constructor of a material, when the members are made that they follow from, and never after.
    MaterialTraits traits_;
    MaterialInside inside_;
};

} // namespace abbe
