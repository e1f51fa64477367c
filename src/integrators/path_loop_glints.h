// The part of the path loop for glints, small images of lamps in mirrors and clear glass, that are probed instead: what
// a path leaves out of them (GlintPlan). Included by path_loop.h.
#pragma once

namespace abbe {

// At a surface, before the path goes on.
template <EffectBits E> void PathLoop<E>::meetGlint(const Bsdf& bsdf, const Directions& eye, const BsdfSample& next) {
    auto& traced = path_.traced;
    if (traced.glintsOfRow.empty() || !traced.mirrored || !next.lobe.has(Lobe::delta)) return;
    traced.events.add(next.lobe.has(Lobe::transmission));
    traced.forced = traced.forced && isForced(bsdf, eye.wo, next);
}

template <EffectBits E> bool PathLoop<E>::probed(const Light* light) const {
    const auto& traced = path_.traced;
    if (traced.glintsOfRow.empty() || !traced.mirrored || !traced.forced || traced.events.length() == 0) return false;
    const GlintPlan& plan = *context_.glints;
    return plan.has(light) && plan.covers(traced.glintsOfRow, traced.events, traced.film);
}

} // namespace abbe
