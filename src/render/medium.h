// What fills space: fog, smoke, cloud, milk.
#pragma once

#include "math/bounds.h"
#include "render/effects.h"
#include "render/medium_emission.h"
#include "render/phase_function.h"
#include "render/ray.h"
#include "render/walk_space.h"
#include "spectrum/curve.h"

namespace abbe {

// One ray through one medium: its segments in order, between which there is nothing, and the density on them.
class MediumWalk {
  public:
    // The next segment, or false at the end. Segments do not overlap, end by the tMax of the walk and are finitely
    // many.
    virtual bool next(MediumSegment&) noexcept = 0;
    // Density at a distance along the ray, within the last segment; finite, >= 0.
    virtual float density(float t) noexcept = 0;
    // In place of Medium::albedo(), at such a distance; called only where Medium::albedoVaries().
    virtual Spectrum albedo(float, const Wavelengths&) noexcept { return Spectrum(1.f); }

  protected:
    ~MediumWalk() = default; // never deleted: walks are trivially destructible and live in a WalkSpace
};

// Extinction is density(x) · extinction(λ): absorption and scattering vary in space together. Immutable, thread-safe,
// render space.
class Medium {
  public:
    // Its place in Scene::media, set by whoever keeps it, for what is counted and charged.
    std::uint16_t number = 0;

    virtual ~Medium() = default;
    // Of the density's support; infinite for media without an end of their own.
    virtual Bounds3 bounds() const = 0;
    // Null if the ray does not meet it before tMax (which may be infinite).
    virtual MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept = 0;
    virtual const Curve& extinction() const = 0; // 1/m at density 1
    virtual const Curve& albedo() const = 0;     // share of the extinction that is scattering, in [0, 1]
    virtual const PhaseFunction& phase() const = 0;
    // True where the walk's albedo() tells more than albedo(), which then bounds it.
    virtual bool albedoVaries() const { return false; }
    // Null for media that do not shine.
    virtual const MediumEmission* emission() const { return nullptr; }

    Effects needs() const {
        Effects effects = Effect::media;
        if (!extinction().isConstant()) effects |= Effect::dispersion; // collisions depend on wavelength
        return effects;
    }
};

} // namespace abbe
