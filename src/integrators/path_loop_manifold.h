// The part of the path loop for caustics that are seen through glass or in mirrors: light that chains of delta
// interfaces bring to the first vertex behind others of them. No light path can show it to the lens, and a path from
// the camera finds a small lamp by luck alone. It is found by manifold sampling, and left out where a path has met such
// a lamp by such a chain. Included by path_loop.h.
#pragma once

namespace abbe {

template <EffectBits E>
void PathLoop<E>::askManifold(const SurfaceHit& hit, const Bsdf& bsdf, const Directions& eye, std::uint32_t depth) {
    constexpr std::uint32_t kNumbers = 0x20000000; // beyond those of vertices
    auto& traced = path_.traced;
    traced.asks =
        context_.manifold && depth > 0 && traced.mirrored && bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy);
    if (!traced.asks) return;
    ChainStart& start = tracedView_->start;
    const Vec3 n = hit.shading.z;
    start.receiver = Receiver(hit.p, eye.wo.z < 0 ? -n : n, false);
    start.pError = hit.pError;
    start.ng = hit.ng;
    start.time = path_.time;
    start.around = path_.nested.here;
    RandomStream random = sampler_.stream(kNumbers + depth);
    const std::uint32_t estimates = context_.manifold->plan().estimates;
    for (std::uint32_t i = 0; i < estimates; ++i)
        askForChain(hit, bsdf, eye, depth, 1 / static_cast<float>(estimates), random);
}

// One estimate, of which a share counts.
template <EffectBits E>
void PathLoop<E>::askForChain(const SurfaceHit& hit, const Bsdf& bsdf, const Directions& eye, std::uint32_t depth,
                              float share, RandomStream& random) {
    const ChainStart& start = tracedView_->start;
    MediumTracker* media = nullptr;
    if constexpr (kMedia) media = &media_.tracker;
    const auto found = context_.manifold->sample(start, path_.lambda, random, counters_.manifold, media);
    Spectrum light(0.f), chance(0.f);
    const std::uint32_t most = context_.settings.maxDepth; // camera paths see no light beyond it
    if (found && (most == 0 || depth + static_cast<std::uint32_t>(found->length) < most)) {
        const Vec3 wi = hit.shading.toLocal(found->wi);
        const BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
        if (sidesAgree(hit, eye, wi, found->wi) && dot(found->wi, start.receiver.n) > 0) {
            const Spectrum& densities = path_.densities.unidirectional;
            const Spectrum scattered =
                path_.beta * eval.fcos * (1 / (found->heroOnly ? densities[0] : mean(densities)));
            light = scattered * found->irradiance;
            if (eval.pdfSolidAngle > 0) chance = scattered * found->radiance * (1 / eval.pdfSolidAngle);
        }
    }
    if (context_.hears) [[unlikely]]
        context_.hears->asked(start, path_.beta, path_.lambda, light, chance);
    if (anyNonZero(light))
        gather(light * share, found->light, false, [&] { observer_->chains(found->light, found->wi); });
}

// A chain starts where it was asked for, in any direction but that of a mirror, on the side of the eye.
template <EffectBits E> void PathLoop<E>::followChain(const SurfaceHit& hit, const BsdfSample& next, Vec3 direction) {
    auto& traced = path_.traced;
    if (traced.asks && !path_.delta && !next.lobe.has(Lobe::transmission)) {
        traced.chain.start();
        traced.chainDirection = direction;
    } else if (traced.asks || !path_.delta) {
        traced.chain.stop();
    } else if (context_.manifold) {
        context_.manifold->follow(traced.chain, hit.shape, next.lobe);
    }
    traced.gathered |= traced.gathers && !path_.delta;
    traced.mirrored &= path_.delta;
}

template <EffectBits E> template <typename Met> bool PathLoop<E>::covered(Met met) const {
    const auto& traced = path_.traced;
    return traced.chain.following && context_.manifold &&
           context_.manifold->covers(traced.chain, tracedView_->start, traced.chainDirection, met(), path_.lambda);
}

} // namespace abbe
