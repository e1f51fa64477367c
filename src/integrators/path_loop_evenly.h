// The part of the path loop for directions some of which are drawn evenly (LoopTechnique::evenly). Included by
// path_loop.h.
#pragma once

namespace abbe {

// What stands for the scattering at a surface some of whose directions are drawn evenly.
template <EffectBits E> const Bsdf* PathLoop<E>::evenly(const SurfaceHit& hit, Vec3 direction, std::uint32_t depth) {
    const Bsdf& own = *hit.material->bsdf(hit, path_.lambda, arena_);
    float eta = 1;
    if (const Curve* inside = hit.material->ior()) {
        eta = inside->at(path_.lambda)[0];
        if (hit.outside) eta /= hit.outside->at(path_.lambda)[0];
        if (dot(hit.shading.z, direction) > 0) eta = 1 / eta; // on the way out
    }
    return arena_.make<DefensiveBsdf>(own, eta, context_.how.evenShare(depth));
}

} // namespace abbe
