// Scattering of light paths at a surface: the adjoint of what camera paths do there.
#pragma once

#include "render/material.h"

namespace abbe {

// What light that arrives from `from` sends towards `away`, and how both kinds of path find the pair of directions.
struct LightScattering {
    Spectrum fcos;           // 1/sr of `away`
    float pdfSolidAngle = 0; // with which LightVertex::sample() draws `away`, 1/sr
    [[no_unique_address]] DensityRatio pdfRatio{Spectrum(1.f)};
    float pdfReverse = 0; // with which a camera path that comes from `away` goes on towards `from`, 1/sr
    [[no_unique_address]] DensityRatio reverseRatio{Spectrum(1.f)};
};

struct LightVertexSample {
    Vec3 away;                  // render space
    LightScattering scattering; // towards it; the path goes on with fcos / pdfSolidAngle of its light
    Lobes lobe;
    float eta = 1; // as in BsdfSample; a dispersive delta transmission belongs to the hero alone there, too
};

// Bsdfs are those of camera paths: they share light between layers by the direction of the eye, may not be reciprocal,
// and bend normals towards the eye. Light paths therefore ask the Bsdf that the eye would see in `away` for light from
// `from`, f(away, from), and turn its cosine into theirs. With shading normal ns and geometric normal ng, camera paths
// carry radiance by f |from·ns| per solid angle of `from`; flux, which light paths carry, is then scattered by
//     f(away, from) |from·ns| |away·ng| / |from·ng|        per solid angle of `away`,
// in which refraction's 1/η² and the correction for shading normals [Veach1997, §5.2, §5.3.2] are contained.
//
// Directions are drawn with the Bsdf that light itself sees. Where normals bend towards the eye, or a sheet has two
// different sides, these may miss some of what the eye sees by that light: pdfSolidAngle is 0 there, and camera paths
// have all of it.
class LightVertex {
  public:
    // `hit`: as the intersector made it, before Material::bend(); its arrival is the direction of travel of the light.
    // Requires Material::reversible(). All outlive this; `eye` is emptied for every question.
    LightVertex(const SurfaceHit& hit, const Wavelengths& lambda, Arena& own, Arena& eye)
        : hit_(hit), lambda_(lambda), eye_(eye), own_(seenAlong(hit.arrival, own)) {}

    // What a path sees that arrives in a direction.
    struct View {
        Frame frame;
        const Bsdf* bsdf;
    };

    const Bsdf& bsdf() const { return *own_.bsdf; }
    // What a camera path sees that comes from `away`: until the next question. At a point, materials that do not bend
    // look the same from everywhere.
    View seen(Vec3 away) const {
        if (!hit_.material->bends() && !(hit_.footprint > 0)) return own_;
        eye_.reset();
        return seenAlong(-away, eye_);
    }

    // `away`: unit, render space; what delta lobes scatter is left out.
    LightScattering towards(Vec3 away) const noexcept {
        LightScattering result{Spectrum(0.f)};
        const View eye = seen(away);
        const Vec3 from = -hit_.arrival, a = eye.frame.toLocal(away), f = eye.frame.toLocal(from);
        if (!sidesAgree(a, f, away)) return result;
        const BsdfEval back = eye.bsdf->eval(a, f, Transport::radiance);
        const BsdfEval ahead =
            own_.bsdf->eval(own_.frame.toLocal(from), own_.frame.toLocal(away), Transport::importance);
        result.fcos = back.fcos * projected(away);
        result.pdfSolidAngle = ahead.pdfSolidAngle;
        result.pdfRatio = ahead.pdfRatio;
        result.pdfReverse = back.pdfSolidAngle;
        result.reverseRatio = back.pdfRatio;
        return result;
    }

    // The same for delta lobes alone, where one of them leads from one direction to the other: all that do, over the
    // delta that sample() has for `away`. `eta`: the index on the side of `away` over that on the side of `from`; 1 for
    // a reflection.
    LightScattering deltaTowards(Vec3 away, float eta) const noexcept {
        LightScattering result{Spectrum(0.f)};
        const View eye = seen(away);
        const Vec3 from = -hit_.arrival, a = eye.frame.toLocal(away), f = eye.frame.toLocal(from);
        if (!sidesAgree(a, f, away)) return result;
        const DeltaEval back = eye.bsdf->evalDelta(a, f);
        const DeltaEval ahead = own_.bsdf->evalDelta(own_.frame.toLocal(from), own_.frame.toLocal(away));
        // Refraction spreads solid angles: dω(away) = spread dω(from), with the normal h ~ from + η away.
        float spread = 1;
        if (eta != 1) {
            const Vec3 h = f + a * eta;
            spread = std::abs(dot(f, h) / dot(a, h)) / square(eta);
        }
        result.fcos = back.ratio * (projected(away) * spread);
        result.pdfSolidAngle = ahead.probability;
        result.pdfReverse = back.probability * spread;
        return result;
    }

    // uLobe, u in [0, 1). Nothing: the path ends here.
    std::optional<LightVertexSample> sample(float uLobe, Vec2 u) const noexcept {
        const auto s = own_.bsdf->sample(own_.frame.toLocal(-hit_.arrival), uLobe, u, Transport::importance);
        if (!s) return std::nullopt;
        LightVertexSample result{own_.frame.toWorld(s->wi), {Spectrum(0.f)}, s->lobe, s->eta};
        if (s->lobe.has(Lobe::delta)) {
            result.scattering = deltaTowards(result.away, s->eta);
        } else {
            result.scattering = towards(result.away);
            result.scattering.pdfSolidAngle = s->pdfSolidAngle; // closer than from rounded directions
            result.scattering.pdfRatio = s->pdfRatio;
        }
        if (!(result.scattering.pdfSolidAngle > 0) || !anyNonZero(result.scattering.fcos)) return std::nullopt;
        return result;
    }

  private:
    View seenAlong(Vec3 arrival, Arena& arena) const {
        const Material& material = *hit_.material;
        if (!material.bends() && !material.usesTextures()) return {hit_.shading, material.bsdf(hit_, lambda_, arena)};
        SurfaceHit hit = hit_;
        hit.arrival = arrival;
        material.bend(hit);
        return {hit.shading, material.bsdf(hit, lambda_, arena)};
    }
    // As for camera paths: shading normals neither open a surface nor close it.
    bool sidesAgree(Vec3 a, Vec3 f, Vec3 away) const {
        const float geometrically = -dot(away, hit_.ng) * dot(hit_.arrival, hit_.ng);
        return a.z * f.z > 0 ? geometrically > 0 : geometrically <= 0;
    }
    float projected(Vec3 away) const { return std::abs(dot(away, hit_.ng) / dot(hit_.arrival, hit_.ng)); }

    const SurfaceHit& hit_;
    const Wavelengths& lambda_;
    Arena& eye_;
    View own_;
};

} // namespace abbe
