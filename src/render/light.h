// The interfaces of lights, as next-event estimation, BSDF sampling and light paths see them.
#pragma once

#include "math/bounds.h"
#include "math/vec.h"
#include "render/ray.h"
#include "render/receiver.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

#include <cmath>
#include <cstdint>
#include <optional>

namespace abbe {

// A point of a light from which a light path starts. Drawn with no regard to any receiver. Render space.
struct LightOrigin {
    // Where light leaves to: everywhere, from a point without a surface; or from the outer side, or both, of a surface.
    enum class Sides : std::uint8_t { all, front, both };

    // On a light that is a point: its density is a delta.
    static LightOrigin at(Vec3 point, float time, float largest) {
        LightOrigin origin;
        origin.p = point;
        origin.time = time;
        origin.pdf = 1;
        origin.largest = largest;
        return origin;
    }

    Vec3 p;
    Vec3 pError;       // bound on the absolute error of p, per axis
    Vec3 n;            // unit, outside; 0 without a surface
    float pdf = 0;     // 1/m², of the point among those of its part; 1 without a surface
    float largest = 0; // 1/sr: the largest density of the light's own directions there
    Sides sides = Sides::all;
    float time = 0;       // Ray::time
    Spectrum factor{1.f}; // what dims the light there: a texture

    bool point() const { return sides == Sides::all; }
    // What turns radiance into exitance: |cos θ| in the unit direction w, 1 without a surface.
    float cosine(Vec3 w) const { return point() ? 1.f : std::abs(dot(n, w)); }
};

// Where a light is and where it emits, for choosing among many lights. Holds whatever the light, or one part of it,
// gives off while the shutter is open: light leaves points of the box, in directions within acos(cosEmission) of a
// normal that is within acos(cosNormals) of the axis. Wider is never wrong, only slower to converge; what is narrower
// than the light loses light.
struct LightBounds {
    Bounds3 box;           // render space
    Vec3 axis{0, 0, 1};    // unit, of the cone of normals
    float cosNormals = -1; // of its half angle; -1: all directions
    float cosEmission = 0; // of the angle to a normal up to which light leaves; -1: everywhere
    bool twoSided = false; // the same along -axis
    float power = 0;       // as Light::visiblePower(); 0: dark
};

class MediumEmission;

// Light arriving from one direction. Delta lights carry in `radiance` what a density of 1 makes right: intensity / d².
struct LightSample {
    LightSample(Vec3 direction, Vec3 point, float toPoint, const Spectrum& arriving, float pdf, bool isDelta = false)
        : wi(direction), p(point), distance(toPoint), radiance(arriving), pdfSolidAngle(pdf), delta(isDelta) {}

    Vec3 wi;             // unit, towards the light
    Vec3 p;              // the point on the light, moved off its surface, for the shadow ray; unused at infinity
    float distance;      // to that point; infinite for distant lights
    Spectrum radiance;   // W·m⁻²·sr⁻¹·nm⁻¹
    float pdfSolidAngle; // > 0
    bool delta;          // cannot be hit by chance, as points and beams: MIS weight 1
    Vec3 n;              // unit normal of the light's surface at that point, outside; 0 where it has none
};

// How paths of light can start at a light.
enum class LightPaths : std::uint8_t {
    none,    // not at all: it is dark, or a medium that emits, which is found along rays alone
    placed,  // at points of it: a PlacedLight
    distant, // in a direction, from infinitely far away, all across the scene alike: a DistantLight
};

// How much light there is, for choosing among lights. W.
struct LightOutput {
    // Of all wavelengths; 0 only if it is dark or cannot be sampled. Infinite lights: through the scene's bounding
    // disk.
    double power = 0;
    // The same as far as the film sees it: weighted with CIE ȳ, and a twentieth of all, so that no light counts for
    // nothing.
    double visiblePower = 0;
    // Of lights without bounds: an estimate of how much they give to a surface that faces them, W/m² weighted likewise.
    double irradiance = 0;
    // Shape of the spectrum of that power, of any scale; null if the light cannot tell.
    const Curve* spectrum = nullptr;
    // The same radiance from everywhere: scattering finds it at least as well as any sample of it.
    bool even = false;

    // Where the visible share is not known: daylight's.
    static constexpr double kDaylightShare = 0.4;
};

// Where a light emits along a ray, and what point it emits from, more or less: distances drawn around it find more of
// the light. Depends on nothing but the light and the ray.
struct LightReach {
    Vec3 centre;
    float tNear = 0, tFar = 0; // light arrives nowhere else; tFar may be infinite
};

class DistantLight;
class PlacedLight;

// What every light has. It is also a DistantLight, a PlacedLight (perhaps a
// SurfaceLight), or a medium that emits. Immutable once the scene is committed, thread-safe, render space.
class Light {
  public:
    virtual ~Light() = default;
    // Which rays hit it; whatever this says, next-event estimation samples it. Set before the scene is committed.
    Visibility visible() const { return visible_; }
    void setVisible(Visibility v) { visible_ = v; }
    // Called once, after the bounds of all finite geometry are known and before anything else.
    virtual void commit(const Bounds3&) {}
    virtual LightOutput output() const = 0;
    double power() const { return output().power; }
    double visiblePower() const { return output().visiblePower; }
    double irradiance() const { return output().irradiance; }
    const Curve* powerShape() const { return output().spectrum; }
    // Lights may consist of parts that are chosen and sampled one at a time (the polygons of a mesh). Fixed, > 0.
    virtual std::uint32_t parts() const { return 1; }
    // Where a part is; nothing if it is infinite or not known. Requires: part < parts(), after commit().
    virtual std::optional<LightBounds> bounds(std::uint32_t /*part*/) const { return std::nullopt; }
    // The part whose surface was hit.
    std::uint32_t partOf(const SurfaceHit& hit) const { return parts() > 1 ? hit.primitive : 0; }
    // Light of a part that can arrive at `from`; nothing if none can. All that counts there (render/receiver.h) has a
    // density; u in [0, 1)². Here and below `time` is Ray::time, which only lights that move look at.
    virtual std::optional<LightSample> sample(const Receiver& from, std::uint32_t part, Vec2 u, const Wavelengths&,
                                              float time) const noexcept = 0;
    // Where along a ray this light can arrive, up to tMax; nothing for lights without a place or out of reach.
    virtual std::optional<LightReach> reach(const Ray&, float) const noexcept { return std::nullopt; }
    // True if it has an extent, but nothing that rays could hit: found by sampling alone, and its samples are deltas
    // whose density counts.
    virtual bool hasNoSurface() const { return false; }
    // Whether nothing that was scattered hits it, whatever its extent.
    bool neverHit() const { return hasNoSurface() || !visible_.has(RayKind::scattered); }

    // What some lights are besides; null if this is none.
    virtual const DistantLight* asDistant() const { return nullptr; }
    virtual const PlacedLight* asPlaced() const { return nullptr; }
    // What this light samples, if it is a medium that emits: found along rays, never as a surface.
    virtual const MediumEmission* emission() const { return nullptr; }

    // True if rays that leave the scene hit it.
    bool infinite() const;
    LightPaths paths() const {
        if (!(power() > 0)) return LightPaths::none;
        return asDistant() ? LightPaths::distant : asPlaced() ? LightPaths::placed : LightPaths::none;
    }

  private:
    Visibility visible_ = kVisibleToAll;
};

// Infinitely far away.
class DistantLight : public Light {
  public:
    const DistantLight* asDistant() const final { return this; }
    // False for a single direction, which no ray has but by sampling: escaped() is not called then.
    virtual bool hasExtent() const { return true; }
    // Radiance arriving along a ray of unit direction `w` that left the scene, and the density with which
    // sample(from, 0, ·) makes that direction.
    virtual Spectrum escaped(Vec3 w, const Wavelengths&, float time) const noexcept = 0;
    virtual float pdfEscaped(const Receiver& from, Vec3 w, float time) const noexcept = 0;
    // Of the irradiance that output() states, what may arrive at a receiver, roughly, for choosing among lights: in
    // [0, 1], 0 only if nothing that counts there can.
    virtual float inSight(const Receiver&) const noexcept { return 1; }

    // Paths that start here: a direction for the scene as a whole, as sample() has it, and its density, 1/sr, for the
    // unit direction w to the light. All that gives light has a density. A delta carries irradiance.
    virtual std::optional<LightSample> sampleDistant(Vec2 u, const Wavelengths& lambda, float time) const noexcept {
        return sample(Vec3{}, 0, u, lambda, time);
    }
    virtual float pdfDistant(Vec3 w, float time) const noexcept { return pdfEscaped(Vec3{}, w, time); }
};

// At a place in the scene: a point, or something with an extent.
class PlacedLight : public Light {
  public:
    const PlacedLight* asPlaced() const final { return this; }

    // Paths that start here. A point of a part, of which every one that gives light has a density; nothing where there
    // is none. u in [0, 1)².
    virtual std::optional<LightOrigin> sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths&,
                                                    float time) const noexcept = 0;
    // The same for a point of the part that is known, with its unit normal: its density (0 if sampleOrigin() cannot
    // make it), and `factor` left at 1. Lights that are a point need neither.
    virtual LightOrigin originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept = 0;
    // The light's own distribution of unit directions, about in proportion to the light that leaves: a direction, and
    // the density of any, 1/sr. Directions into which light leaves have a density.
    virtual Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept = 0;
    virtual float pdfDirection(const LightOrigin&, Vec3 w) const noexcept = 0;
    // Radiance that leaves in a unit direction, W·m⁻²·sr⁻¹·nm⁻¹; without a surface intensity, W·sr⁻¹·nm⁻¹.
    virtual Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths&) const noexcept = 0;
    // Density with which sample(from, part, ·) makes a point of the part of which no more is known than its unit
    // normal; 0 for lights that are a point.
    virtual float pdfAtPoint(const Receiver& /*from*/, std::uint32_t /*part*/, Vec3 /*p*/, Vec3 /*n*/,
                             float /*time*/) const noexcept {
        return 0;
    }
};

// A surface that rays hit: what SurfaceHit::light is.
class SurfaceLight : public PlacedLight {
  public:
    // Radiance that leaves `hit` in the unit direction `w`, and the density with which sample(from, partOf(hit), ·)
    // makes that point.
    virtual Spectrum emitted(const SurfaceHit& hit, Vec3 w, const Wavelengths&) const noexcept = 0;
    virtual float pdfSolidAngle(const Receiver& from, const SurfaceHit& hit, float time) const noexcept = 0;
};

inline bool Light::infinite() const {
    const DistantLight* const distant = asDistant();
    return distant && distant->hasExtent();
}

} // namespace abbe
