// Normals other than the surface's: from textures of directions, and those of the parts of a material.
#pragma once

#include "render/material.h"
#include "render/surface_input.h"

namespace abbe {

// Textures of directions.

// A texture of slopes: what bends the shading normal.
struct NormalMap {
    const Texture* texture = nullptr; // three channels, 0 … 1 for -1 … 1
    float strength = 1;               // factor of x and y
};

// The unit normal that the map says, in ng's hemisphere or not: `hit` unbent. Where there are no texture coordinates
// (dpdu = 0) it says nothing.
Vec3 mappedNormal(const NormalMap&, const SurfaceHit& hit);

// The scattering of a material that is a part of another one, in the frame of the whole.

// A Bsdf whose normal is another one. Directions that lie on different sides of the two surfaces are lost, as they are
// between shading and geometric normal: what the part reflects, the whole must not let through.
class TurnedBsdf final : public Bsdf {
  public:
    // `own`: the axes of the inner frame in the outer one.
    TurnedBsdf(const Bsdf& inner, const Frame& own) : inner_(inner), own_(own) {}

    Lobes lobes() const noexcept override { return inner_.lobes(); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        const Vec3 o = own_.toLocal(wo), i = own_.toLocal(wi);
        return sidesAgree(wo, wi, o, i) ? inner_.eval(o, i, transport) : BsdfEval{};
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        const Vec3 o = own_.toLocal(wo);
        auto result = inner_.sample(o, uLobe, u, transport);
        if (!result) return result;
        const Vec3 i = result->wi;
        result->wi = own_.toWorld(i);
        if (!sidesAgree(wo, result->wi, o, i)) result.reset();
        return result;
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        const Vec3 o = own_.toLocal(wo), i = own_.toLocal(wi);
        return sidesAgree(wo, wi, o, i) ? inner_.evalDelta(o, i) : DeltaEval{};
    }

  private:
    static bool sidesAgree(Vec3 wo, Vec3 wi, Vec3 o, Vec3 i) {
        return ((wo.z > 0) == (wi.z > 0)) == ((o.z > 0) == (i.z > 0));
    }
    const Bsdf& inner_;
    Frame own_;
};

// The part at `hit`, where it may bend the normal for itself. Requires hit.arrival if it does.
inline const Bsdf& partBsdf(const Material& part, const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) {
    if (!part.bends()) return *part.bsdf(hit, lambda, arena);
    SurfaceHit own = hit;
    part.bend(own);
    const Frame& outer = hit.shading;
    const Frame turned{outer.toLocal(own.shading.x), outer.toLocal(own.shading.y), outer.toLocal(own.shading.z)};
    return *arena.make<TurnedBsdf>(*part.bsdf(own, lambda, arena), turned);
}

} // namespace abbe
