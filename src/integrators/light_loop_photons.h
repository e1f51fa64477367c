// The part of the light loop for what its paths leave behind for merging. Included by light_loop.h.
#pragma once

namespace abbe {

template <EffectBits E>
template <typename Tell>
void LightLoop<E>::leavePhotons(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell) {
    photons_ = true;
    walk(
        start, lambda,
        [&](const SurfaceHit& hit, const LightVertex& vertex, const VertexSample&, std::uint32_t depth) {
            if (depth == 0 || !vertex.bsdf().lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return;
            Photon photon = photonOf(start, hit.p, hit.arrival, depth);
            photon.ng = hit.ng;
            photon.followed = followedFrom(start, hit);
            tell(photon);
        },
        [&](Vec3 p, Vec3 direction, const VertexSample&, std::uint32_t depth) {
            Photon photon = photonOf(start, p, direction, depth);
            photon.medium = this->collided_;
            tell(photon);
        });
}

template <EffectBits E>
Photon LightLoop<E>::photonOf(const EmittedRay& start, Vec3 p, Vec3 direction, std::uint32_t depth) const {
    const auto& path = this->path_;
    Photon photon;
    photon.p = p;
    photon.wi = -direction;
    photon.flux = path.beta;
    photon.densities = path.densities.unidirectional;
    photon.light = start.light;
    photon.target = start.target;
    photon.aim = start.aim;
    Rivals meeting = rivals_;
    meeting.asked = 0;
    photon.cameraOdds = static_cast<float>(meeting.of(1, Spectrum(1.f), path.densities.heroOnly));
    photon.vertices = depth;
    photon.heroOnly = path.densities.heroOnly;
    return photon;
}

// Camera paths would meet the links the other way round, on the side that the light came from.
template <EffectBits E> bool LightLoop<E>::followedFrom(const EmittedRay& start, const SurfaceHit& hit) const {
    const ManifoldSampler* const sampler = this->context_.manifold;
    if (!sampler || linkCount_ > kMostLinks) return false;
    CoveredChain chain;
    chain.start();
    for (std::size_t i = linkCount_; i-- > 0;) sampler->follow(chain, links_[i].shape, links_[i].lobe);
    if (start.unmet) return sampler->coversKind(chain, start.light);
    const float time = this->path_.time;
    ChainStart from;
    from.receiver = Receiver(hit.p, hit.shading.z, true);
    from.pError = hit.pError;
    from.ng = hit.ng;
    from.time = time;
    from.around = this->path_.nested.here;
    return sampler->covers(chain, from, -hit.arrival, LightTarget::begun(start, time), this->path_.lambda);
}

} // namespace abbe
