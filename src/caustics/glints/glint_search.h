// Camera paths over delta interfaces, by which a pilot looks for glints.
#pragma once

#include "caustics/shared/chain_signature.h"
#include "render/bsdf.h"
#include "render/light.h"
#include "render/surface_hit.h"
#include "spectrum/spectrum.h"

#include <optional>

namespace abbe {

// A delta lobe that is taken on purpose and not by chance.
struct ForcedLobe {
    BsdfSample sample;     // of density 1: its weight is the ratio of the deltas
    float probability = 0; // with which sample() takes it
};

// The one that mirrors, or lets through. It is looked for at both ends of the range of lobe choices, which finds all of
// a material with two lobes; whatever else a material may do is left to chance, and isForced() tells it apart.
inline std::optional<ForcedLobe> forcedLobe(const Bsdf& bsdf, Vec3 wo, bool transmission) {
    for (const float choice : {0.f, 0x1.fffffep-1f}) {
        auto s = bsdf.sample(wo, choice, {0.5f, 0.5f}, Transport::radiance);
        if (!s || !s->lobe.has(Lobe::delta) || s->lobe.has(Lobe::transmission) != transmission) continue;
        const DeltaEval all = bsdf.evalDelta(wo, s->wi);
        if (!(all.probability > 0)) continue;
        s->weight = all.ratio;
        s->pdfSolidAngle = 1;
        return ForcedLobe{*s, all.probability};
    }
    return std::nullopt;
}

// Whether a sampled delta lobe is the one that forcedLobe() gives.
inline bool isForced(const Bsdf& bsdf, Vec3 wo, const BsdfSample& sampled) {
    const auto forced = forcedLobe(bsdf, wo, sampled.lobe.has(Lobe::transmission));
    return forced && lengthSquared(forced->sample.wi - sampled.wi) < 1e-9f;
}

// A segment behind the first event.
struct GlintView {
    const ChainSignature& chain; // so far
    Vec3 p, direction;           // where it starts, and where to, unit
    Spectrum throughput;         // radiance at the eye over that of what is seen here, per lane
    double probability;          // with which a camera path would have taken these events
    const SurfaceHit* hit;       // where it ends; null: nowhere
    float time = 0;              // as Ray::time

    // What a light gives in this direction, if it is what is seen.
    Spectrum emitted(const Light& light, const Wavelengths& lambda) const {
        if (hit) return hit->light == &light ? hit->light->emitted(*hit, -direction, lambda) : Spectrum(0.f);
        const DistantLight* const distant = light.asDistant();
        return distant && distant->hasExtent() ? distant->escaped(direction, lambda, time) : Spectrum(0.f);
    }
};

struct GlintQuery {
    Vec2 film;                           // as CameraSample::film
    float wavelength = 0.5f;             // of the hero, as WavelengthDensity::sample() takes it
    std::optional<ChainSignature> chain; // which events to take; without them they are drawn, either alike
    std::uint64_t seed = 0;              // for that, and for the place on the lens and the time
};

} // namespace abbe
