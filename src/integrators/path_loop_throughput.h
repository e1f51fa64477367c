// The part of the path loop for what a path still carries: how it is dimmed, whether it goes on, and when it is down to
// one wavelength. Included by path_loop.h.
#pragma once

#include <limits>

namespace abbe {

template <EffectBits E> float PathLoop<E>::throughput() const {
    // Tracking scales the densities: only their ratio to beta means anything. Beyond a bound beta may have a sign.
    if constexpr (kMedia && kDispersion)
        return mean(abs(path_.beta)) / mean(path_.densities.unidirectional) * path_.etaScale;
    if constexpr (kMedia) return mean(abs(path_.beta)) * path_.etaScale;
    return mean(path_.beta) * path_.etaScale;
}

// Asked by loops that may be long, whose body has run so often.
template <EffectBits E> bool PathLoop<E>::toldToLeave(std::uint32_t count) {
    constexpr std::uint32_t kLongLoop = 64;
    if (count % kLongLoop != kLongLoop - 1) [[likely]]
        return false;
    return leavesIfTold();
}

// If the render is to end the path is left: what it has gathered is no number, which its gate (tile_kernel.h) does not
// let through.
template <EffectBits E> [[gnu::cold, gnu::noinline]] bool PathLoop<E>::leavesIfTold() {
    if (!context_.toldToStop()) return false;
    counters_.left = true;
    path_.beta = Spectrum(0.f);
    path_.radiance = Spectrum(std::numeric_limits<float>::quiet_NaN());
    return true;
}

// At a surface, or else where it collided last.
template <EffectBits E> [[gnu::cold, gnu::noinline]] void PathLoop<E>::cap(const SurfaceHit* hit) {
    ++counters_.capped;
    counters_.cappedIn = hit ? static_cast<const void*>(hit->shape) : collided_;
}

// 0 where the render is to end. Out of line, so that short paths do not pay for it.
template <EffectBits E> [[gnu::noinline]] float PathLoop<E>::longSurvival(std::uint32_t depth) {
    return toldToLeave(depth) ? 0 : longPathSurvival(depth);
}

template <EffectBits E> bool PathLoop<E>::survives(std::uint32_t depth, float rouletteScale) {
    if (depth == 0) return true; // the first bounce carries most of the image
    const float scale = path_.delta ? std::max(rouletteScale, context_.how.leastAfterDelta) : rouletteScale;
    float p = RouletteReference::survival(throughput(), scale);
    // Total reflection in a clear solid can trap a path that loses nothing. Close to 1, because roulette against an
    // albedo ρ has finite variance only for p > ρ².
    if (depth >= kLongPath) [[unlikely]]
        p = std::min(p, longSurvival(depth));
    if (p >= 1) return true;
    if (sampler_.roulette(depth) >= p) return false;
    path_.beta *= 1 / p;
    return true;
}

// Beer–Lambert along `distance` of the segment towards `hit`. A camera inside a dielectric is known by its first hit: a
// boundary met from behind while no interior was entered.
template <EffectBits E> void PathLoop<E>::absorb(const SurfaceHit& hit, Vec3 direction, float distance) {
    if constexpr (kInterfaces) {
        if (const Curve* clear = path_.nested.here.absorption()) path_.beta *= exp(clear->at(path_.lambda) * -distance);
        return;
    }
    const Curve*& absorption = path_.interior.absorption;
    if (!absorption && dot(direction, hit.ng) > 0) absorption = hit.material->absorption();
    if (absorption) path_.beta *= exp(absorption->at(path_.lambda) * -distance);
}

// The direction just taken belongs to the hero alone: the densities of all other lanes are 0, so that the mean of the
// ratios is 1/8 of the hero's and the hero counts eightfold. From here on every lane evaluates the hero's wavelength,
// which keeps means over lanes (lobe choices, roulette) meaningful; only lane 0 still adds to the image.
template <EffectBits E> void PathLoop<E>::endSecondaryWavelengths() {
    if (path_.densities.heroOnly) return;
    path_.densities.heroOnly = true;
    addWorkFlag(WorkFlag::heroOnly);
    if (!(path_.densities.unidirectional[0] > 0)) { // a hero that the media on the way never chose
        path_.beta = Spectrum(0.f);
        return;
    }
    const float hero = path_.beta[0] * (static_cast<float>(kLanes) / path_.densities.unidirectional[0]);
    path_.beta = Spectrum(Float8{hero, 0, 0, 0, 0, 0, 0, 0});
    path_.densities.unidirectional = Spectrum(1.f);
    path_.lambda.keepHero();
}

} // namespace abbe
