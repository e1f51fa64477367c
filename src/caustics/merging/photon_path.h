// Light paths that leave photons for merging.
#pragma once

#include "caustics/light_tracing/light_path.h"
#include "caustics/manifold/manifold_sampler.h"
#include "caustics/merging/photon_map.h"

namespace abbe {

// A light path of MergePlan.
template <EffectBits E> class PhotonPath {
  public:
    // What it is given outlives it; the arenas are those of the path and of its vertices.
    PhotonPath(const PathContext& context, Sampler& sampler, Arena& arena, VertexArenas& vertexArenas,
               PathCounters& counters, typename PathWalk<E>::Media& media)
        : path_(context, sampler, arena, vertexArenas, counters, media) {}

    // Whose start is set from outside.
    PathWalk<E>& walk() { return path_.walk(); }
    // Vertex 0 of the sampler has started the path. Light that no mirror or clear glass has sent is not merged.
    template <typename Tell> void leavePhotons(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell);

  private:
    Photon photonOf(const EmittedRay&, Vec3 p, Vec3 direction, std::uint32_t depth);
    bool followedFrom(const EmittedRay&, const SurfaceHit&);

    LightPath<E> path_;
};

template <EffectBits E>
template <typename Tell>
void PhotonPath<E>::leavePhotons(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell) {
    path_.follow(
        start, lambda, true,
        [&](const SurfaceHit& hit, const LightVertex& vertex, const VertexSample&, std::uint32_t depth) {
            if (depth == 0 || !vertex.bsdf().lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return;
            Photon photon = photonOf(start, hit.p, hit.arrival, depth);
            photon.ng = hit.ng;
            photon.followed = followedFrom(start, hit);
            tell(photon);
        },
        [&](Vec3 p, Vec3 direction, const VertexSample&, std::uint32_t depth) {
            Photon photon = photonOf(start, p, direction, depth);
            photon.medium = walk().collided;
            tell(photon);
        });
}

template <EffectBits E>
Photon PhotonPath<E>::photonOf(const EmittedRay& start, Vec3 p, Vec3 direction, std::uint32_t depth) {
    const auto& path = walk().path;
    Photon photon;
    photon.p = p;
    photon.wi = -direction;
    photon.flux = path.beta;
    photon.densities = path.densities.unidirectional;
    photon.light = start.light;
    photon.target = start.target;
    photon.aim = start.aim;
    photon.cameraOdds = static_cast<float>(path_.cameraOdds());
    photon.vertices = depth;
    photon.heroOnly = path.densities.heroOnly;
    return photon;
}

// Camera paths would hit the links the other way round, on the side that the light came from.
template <EffectBits E> bool PhotonPath<E>::followedFrom(const EmittedRay& start, const SurfaceHit& hit) {
    const ManifoldSampler* const sampler = walk().context.manifold;
    const auto links = path_.links();
    if (!sampler || !links) return false;
    CoveredChain chain;
    chain.start();
    for (std::size_t i = links->size(); i-- > 0;) sampler->follow(chain, (*links)[i].shape, (*links)[i].lobe);
    if (start.neverHit) return sampler->coversKind(chain, start.light);
    const float time = walk().path.time;
    ChainStart from;
    from.receiver = Receiver(hit.p, hit.shading.z, true);
    from.pError = hit.pError;
    from.ng = hit.ng;
    from.time = time;
    from.around = walk().path.nested.here;
    return sampler->covers(chain, from, -hit.arrival, LightTarget::begun(start, time), walk().path.lambda);
}

} // namespace abbe
