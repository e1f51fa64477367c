// The interfaces of what fills space: fog, smoke, clouds, milk, flames.
#pragma once

#include "math/bounds.h"
#include "render/effects.h"
#include "render/ray.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace abbe {

// A stretch of a ray along which a field (the density of a medium) is known to
// stay within bounds. Distances along the ray.
struct MediumSegment {
    float tNear = 0, tFar = 0;
    float minimum = 0, mean = 0, maximum = 0; // of the field; `mean` is any value between, the nearer the better
};

// Where one walk lives; reused from ray to ray.
struct WalkSpace {
    alignas(32) std::byte bytes[1024];

    template <typename T, typename... Args> T* make(Args&&... args) {
        static_assert(sizeof(T) <= sizeof(bytes) && alignof(T) <= 32 && std::is_trivially_destructible_v<T>);
        return new (bytes) T(std::forward<Args>(args)...);
    }
};

// One ray through what emits.
class EmissionWalk {
  public:
    // The next segment in which there may be emission, as MediumWalk::next(); `mean` is that of a relative amount.
    virtual bool next(MediumSegment&) noexcept = 0;
    // Radiance that a metre of the way adds, at a distance along the ray within the last segment: W·m⁻³·sr⁻¹·nm⁻¹.
    virtual Spectrum emitted(float t, const Wavelengths&) noexcept = 0;

  protected:
    ~EmissionWalk() = default; // as MediumWalk
};

// Light that a medium emits: flame, glowing gas. Immutable, thread-safe, render space. A Light may know how to sample
// it (Light::emission()).
class MediumEmission {
  public:
    virtual ~MediumEmission() = default;
    // Null if the ray hits nothing that emits before tMax (which may be infinite).
    virtual EmissionWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept = 0;
    // LightSample::pdfSolidAngle of the sample that its light makes of point `p` seen from `from`; 0 if it has no
    // light. Volumes have a density per m³, p_V; with a characteristic length ℓ, the same for all points, a sample
    // states p_V r² ℓ as its density over directions and ε ℓ as its radiance. Any ℓ is right, since the weights of the
    // two techniques need only add up to 1; near the way through a piece of the field it makes them balance.
    virtual float pdfSolidAngle(Vec3 from, Vec3 p) const noexcept = 0;
};

// Scattering at a point inside a medium: how much goes where. Rotationally symmetric about the direction in which light
// travels. Immutable, thread-safe. `cosine` is that of the angle between the directions of travel before and after: 1
// goes straight on.
class PhaseFunction {
  public:
    virtual ~PhaseFunction() = default;
    // Density over the sphere, 1/sr; its integral is 1.
    virtual float value(float cosine) const noexcept = 0;
    // A cosine whose direction, with an azimuth drawn evenly, has exactly the density value(). u in [0, 1).
    virtual float sampleCosine(float u) const noexcept = 0;
    // True if scattering depends on wavelength: then directions are drawn from value(), one density for all, and
    // weighed by ratio().
    virtual bool spectral() const { return false; }
    // Density at each wavelength over value(); its mean over the sphere, weighed by value(), is 1. Finite.
    virtual Spectrum ratio(float, const Wavelengths&) const noexcept { return Spectrum(1.f); }
};

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

// What fills space. Extinction is density(x) · extinction(λ): absorption and scattering vary in space together.
// Immutable, thread-safe, render space.
class Medium {
  public:
    // Its place in Scene::media, set by whoever keeps it, for what is counted and charged.
    std::uint16_t number = 0;

    virtual ~Medium() = default;
    // Of the density's support; infinite for media without an end of their own.
    virtual Bounds3 bounds() const = 0;
    // Null if the ray does not hit it before tMax (which may be infinite).
    virtual MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept = 0;
    virtual const Curve& extinction() const = 0; // 1/m at density 1
    virtual const Curve& albedo() const = 0;     // share of the extinction that is scattering, in [0, 1]
    virtual const PhaseFunction& phase() const = 0;
    // Of density 1 everywhere, and one albedo.
    virtual bool homogeneous() const { return false; }
    // True where the walk's albedo() tells more than albedo(), which then bounds it.
    virtual bool albedoVaries() const { return false; }
    // Null for media that do not emit.
    virtual const MediumEmission* emission() const { return nullptr; }

    Effects needs() const {
        Effects effects = Effect::media;
        if (!extinction().isConstant()) effects |= Effect::dispersion; // collisions depend on wavelength
        return effects;
    }
};

} // namespace abbe
