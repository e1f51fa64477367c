// The part of the path loop for light that is found by merging instead: what a path leaves out of it (MergePlan).
// Included by path_loop.h.
#pragma once

namespace abbe {

// At a surface, before the path goes on. Light paths end at what is not reversible.
template <EffectBits E> void PathLoop<E>::meetGathering(const SurfaceHit& hit, const Bsdf& bsdf, std::uint32_t depth) {
    if (!context_.merging) return;
    auto& traced = path_.traced;
    const bool reversible = hit.material->reversible();
    traced.gathers =
        reversible && depth > 0 && traced.mirrored && bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy);
    traced.gathered &= reversible;
}

template <EffectBits E> void PathLoop<E>::meetGatheringInMedium(std::uint32_t depth) {
    path_.traced.gathers = context_.merging && depth > 0 && path_.traced.mirrored;
}

template <EffectBits E> bool PathLoop<E>::merged(const Light* light) const {
    return path_.traced.gathered && path_.delta && context_.merging->lights.contains(light);
}

} // namespace abbe
