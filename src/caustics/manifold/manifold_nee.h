// Next-event estimation through chains of delta interfaces: caustics that are seen through glass or in mirrors.
#pragma once

#include "caustics/manifold/manifold_sampler.h"
#include "transport/walk.h"

namespace abbe {

// For light that such chains bring to the first vertex behind others of them. No light path can show it to the lens,
// and a path from the camera finds a small light by luck alone. It is found by manifold sampling, and left out where a
// path has hit such a light by such a chain. The walk outlives it.
template <EffectBits E> class ManifoldNee {
  public:
    explicit ManifoldNee(PathWalk<E>& walk) : walk_(walk) {}

    // At a surface. `specular`: the path has hit nothing but deltas so far.
    void sample(const SurfaceHit&, const Bsdf&, const EyeDirection&, std::uint32_t depth, bool specular);
    // The path has gone on from there in the direction.
    void follow(const SurfaceHit&, const BsdfSample&, Vec3 direction);
    void scatterInMedium() { chain_.stop(); }
    // Whether the light that is hit has been found already; target() makes its LightTarget.
    template <typename Target> bool covers(Target target) const {
        const ManifoldSampler* const manifold = walk_.context.manifold;
        return chain_.following && manifold &&
               manifold->covers(chain_, start_, chainDirection_, target(), walk_.path.lambda);
    }

  private:
    void estimate(const SurfaceHit&, const Bsdf&, const EyeDirection&, std::uint32_t depth, float share, RandomStream&);

    PathWalk<E>& walk_;
    bool sampled_ = false; // at this vertex
    ChainStart start_;     // where it was sampled last
    CoveredChain chain_;   // since then
    Vec3 chainDirection_;  // its first direction
};

template <EffectBits E>
void ManifoldNee<E>::sample(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye, std::uint32_t depth,
                            bool specular) {
    constexpr std::uint32_t kNumbers = 0x20000000; // beyond those of vertices
    const ManifoldSampler* const manifold = walk_.context.manifold;
    sampled_ = manifold && depth > 0 && specular && bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy);
    if (!sampled_) return;
    const Vec3 n = hit.shading.z;
    start_.receiver = Receiver(hit.p, eye.wo.z < 0 ? -n : n, false);
    start_.pError = hit.pError;
    start_.ng = hit.ng;
    start_.time = walk_.path.time;
    start_.around = walk_.path.nested.here;
    RandomStream random = walk_.sampler.stream(kNumbers + depth);
    const std::uint32_t estimates = manifold->plan().estimates;
    for (std::uint32_t i = 0; i < estimates; ++i)
        estimate(hit, bsdf, eye, depth, 1 / static_cast<float>(estimates), random);
}

// One estimate, of which a share counts.
template <EffectBits E>
void ManifoldNee<E>::estimate(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye, std::uint32_t depth,
                              float share, RandomStream& random) {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    MediumTracker* media = nullptr;
    if constexpr (PathWalk<E>::kMedia) media = &walk_.media.tracker;
    const auto found = context.manifold->sample(start_, path.lambda, random, walk_.counters.manifold, media);
    Spectrum light(0.f), chance(0.f);
    const std::uint32_t most = context.settings.maxDepth; // camera paths see no light beyond it
    if (found && (most == 0 || depth + static_cast<std::uint32_t>(found->length) < most)) {
        const Vec3 wi = hit.shading.toLocal(found->wi);
        const BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
        if (walk_.sidesAgree(hit, eye, wi, found->wi) && dot(found->wi, start_.receiver.n) > 0) {
            const Spectrum& densities = path.densities.unidirectional;
            const Spectrum scattered = path.beta * eval.fcos * (1 / (found->heroOnly ? densities[0] : mean(densities)));
            light = scattered * found->irradiance;
            if (eval.pdfSolidAngle > 0) chance = scattered * found->radiance * (1 / eval.pdfSolidAngle);
        }
    }
    if (context.manifoldListener) [[unlikely]]
        context.manifoldListener->sampled(start_, path.beta, path.lambda, light, chance);
    if (anyNonZero(light))
        walk_.estimate.add(light * share, found->light, false,
                           [&] { walk_.estimate.observer->chains(found->light, found->wi); });
}

// A chain starts where it was sampled, in any direction but that of a mirror, on the side of the eye.
template <EffectBits E> void ManifoldNee<E>::follow(const SurfaceHit& hit, const BsdfSample& next, Vec3 direction) {
    const bool delta = walk_.path.delta;
    if (sampled_ && !delta && !next.lobe.has(Lobe::transmission)) {
        chain_.start();
        chainDirection_ = direction;
    } else if (sampled_ || !delta) {
        chain_.stop();
    } else if (walk_.context.manifold) {
        walk_.context.manifold->follow(chain_, hit.shape, next.lobe);
    }
}

} // namespace abbe
