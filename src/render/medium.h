// What fills space: fog, smoke, cloud, milk.
#pragma once

#include "math/bounds.h"
#include "render/effects.h"
#include "render/phase_function.h"
#include "render/ray.h"
#include "spectrum/curve.h"

#include <cstddef>

namespace abbe {

// A stretch of a ray along which a medium's density is known to stay within bounds. Distances along the ray.
struct MediumSegment {
    float tNear = 0, tFar = 0;
    float minimum = 0, mean = 0, maximum = 0; // of the density; `mean` is any value between, the nearer the better
};

// One ray through one medium: its segments in order, between which there is nothing, and the density on them.
class MediumWalk {
  public:
    // The next segment, or false at the end. Segments do not overlap, end by the tMax of the walk and are finitely
    // many.
    virtual bool next(MediumSegment&) noexcept = 0;
    // Density at a distance along the ray, within the last segment; finite, >= 0.
    virtual float density(float t) noexcept = 0;

  protected:
    ~MediumWalk() = default; // never deleted: walks are trivially destructible and live in a WalkSpace
};

// Where one walk lives; reused from ray to ray.
struct WalkSpace {
    alignas(32) std::byte bytes[768];

    template <typename T, typename... Args> T* make(Args&&... args) {
        static_assert(sizeof(T) <= sizeof(bytes) && alignof(T) <= 32 && std::is_trivially_destructible_v<T>);
        return new (bytes) T(std::forward<Args>(args)...);
    }
};

// Extinction is density(x) · extinction(λ): absorption and scattering vary in space together. Immutable, thread-safe,
// render space.
class Medium {
  public:
    virtual ~Medium() = default;
    // Of the density's support; infinite for media without an end of their own.
    virtual Bounds3 bounds() const = 0;
    // Null if the ray does not meet it before tMax (which may be infinite).
    virtual MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept = 0;
    virtual const Curve& extinction() const = 0; // 1/m at density 1
    virtual const Curve& albedo() const = 0;     // share of the extinction that is scattering, in [0, 1]
    virtual const PhaseFunction& phase() const = 0;

    Effects needs() const {
        Effects effects = Effect::media;
        if (!extinction().isConstant()) effects |= Effect::dispersion; // collisions depend on wavelength
        return effects;
    }
};

} // namespace abbe
