// Delta lobes that are taken on purpose and not by chance.
#pragma once

#include "render/bsdf.h"

#include <optional>

namespace abbe {

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

} // namespace abbe
