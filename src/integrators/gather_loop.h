// Camera paths that gather photons: by way of mirrors and clear glass to what spreads light behind them.
#pragma once

#include "integrators/path_loop.h"
#include "integrators/photon_map.h"

namespace abbe {

// What one photon adds to the picture.
struct GatheredLight {
    const Photon& photon;
    Spectrum value;      // radiance at the eye at the wavelengths of the path, over the number of photons
    float kernel = 0;    // 1/m², that is in it
    float closer = 0;    // times `value`: what it would be over half of the area
    float cameraPdf = 0; // 1/sr, of the photon's direction for a camera path at that place
};

// A camera path of MergePlan, walked as those of PathLoop are. It takes no other light.
template <EffectBits E> class GatherLoop : private PathLoop<E> {
    using Base = PathLoop<E>;
    static_assert(Base::kTraced);

  public:
    using Media = typename Base::Media;
    using Base::startIn;
    using Base::startWith;
    using Base::startWithHero;

    GatherLoop(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters, Media& media)
        : Base(context, sampler, arena, counters, media) {}

    // Of photons of the same wavelengths and time, `radius` over that of the path's cone, at least MergePlan's.
    template <typename Tell>
    void gather(Ray ray, const Wavelengths& lambda, const PhotonMap& photons, float radius, Tell&& tell);

  private:
    template <typename Tell>
    void gatherAt(const SurfaceHit&, const Bsdf&, const typename Base::Directions&, std::uint32_t depth,
                  const PhotonMap&, float radius, Tell&& tell);
    // Radiance over the flux per area of the photon, without the scattering between.
    Spectrum joined(const Photon&) const;
    bool goesOn(std::uint32_t depth);
};

template <EffectBits E>
template <typename Tell>
void GatherLoop<E>::gather(Ray ray, const Wavelengths& lambda, const PhotonMap& photons, float radius, Tell&& tell) {
    auto& path = this->path_;
    path.lambda = lambda;
    path.time = ray.time;
    path.densities.film = lambda;
    if (this->startWithHero_) this->endSecondaryWavelengths();
    const float leastSpread = 0.1f * path.cone.spread;
    const auto& settings = this->context_.settings;
    const std::uint32_t most = settings.maxDepth ? settings.maxDepth : Base::kMaxVertices;
    float way = 0; // so far, m
    SurfaceHit hit;
    for (std::uint32_t depth = 0; depth < most; ++depth) {
        this->countRay();
        const Vec3 from = ray.origin, direction = ray.direction;
        if (this->arrive(ray, hit, depth) != Base::Arrival::surface || !anyNonZero(path.beta)) return;
        way += length(hit.p - from);
        hit.arrival = direction;
        hit.footprint = path.cone.radius;
        if (hit.material->bends()) hit.material->bend(hit);
        this->arena_.reset();
        const Bsdf& bsdf = *hit.material->bsdf(hit, path.lambda, this->arena_);
        const typename Base::Directions eye{hit.shading.toLocal(-direction), -direction};
        const Lobes lobes = bsdf.lobes();
        // In a focus of the cone the disk would vanish, and all light in it with it.
        const float reach =
            std::max(radius * std::max(path.cone.radius, leastSpread * way), this->context_.merging->leastRadius);
        if (depth > 0 && hit.material->reversible() && lobes.any(Lobes(Lobe::diffuse) | Lobe::glossy))
            gatherAt(hit, bsdf, eye, depth, photons, reach, tell);
        if (!lobes.has(Lobe::delta)) return;
        const VertexSample sample = this->sampler_.vertex(depth);
        const auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
        if (!next || !next->lobe.has(Lobe::delta)) return;
        if (!this->scatter(hit, *next, eye, ray) || !goesOn(depth)) return;
    }
}

template <EffectBits E>
template <typename Tell>
void GatherLoop<E>::gatherAt(const SurfaceHit& hit, const Bsdf& bsdf, const typename Base::Directions& eye,
                             std::uint32_t depth, const PhotonMap& photons, float radius, Tell&& tell) {
    const std::uint32_t most = this->context_.settings.maxDepth;
    const float area = kPi * square(radius);
    photons.near(hit.p, radius, [&](const Photon& photon, float d2) {
        // Other sides and other surfaces nearby have light of their own.
        if (dot(photon.ng, hit.ng) < 0.5f || std::abs(dot(photon.p - hit.p, hit.ng)) > 0.5f * radius) return;
        if (most > 0 && depth + 1 + photon.vertices > most) return;
        const Vec3 wi = hit.shading.toLocal(photon.wi);
        if (photon.followed && eye.wo.z * wi.z > 0) return; // manifold sampling has it
        if (!this->sidesAgree(hit, eye, wi, photon.wi)) return;
        const BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
        if (!anyNonZero(eval.fcos)) return;
        // The kernel of [Epanechnikov1969] in the plane: 2/(π r²) (1 − d²/r²). Over half of the area likewise.
        const float x = d2 / square(radius), kernel = 2 * (1 - x) / area;
        const float closer = x < 0.5f ? 2 * (1 - 2 * x) / (1 - x) : 0;
        // Flux is spread over the geometric surface, fcos has the cosine of the shading normal.
        const float facing = std::abs(dot(photon.wi, hit.ng));
        if (!(facing > 0)) return;
        tell(GatheredLight{photon, joined(photon) * photon.flux * eval.fcos * (kernel / facing), kernel, closer,
                           eval.pdfSolidAngle});
    });
}

// The balance of the wavelengths [Wilkie2014] over the whole path. Where one half belongs to the hero alone it counts
// eightfold already.
template <EffectBits E> Spectrum GatherLoop<E>::joined(const Photon& photon) const {
    const auto& path = this->path_;
    const Spectrum& own = path.densities.unidirectional;
    if (path.densities.heroOnly && photon.heroOnly) return path.beta * (1.f / static_cast<float>(kLanes));
    if (path.densities.heroOnly) return path.beta * (1 / photon.densities[0]);
    if (photon.heroOnly) return path.beta * (1 / own[0]);
    return path.beta * (1 / mean(own * photon.densities));
}

// Chains of deltas have no end in a hall of mirrors.
template <EffectBits E> bool GatherLoop<E>::goesOn(std::uint32_t depth) {
    if (depth < 4) return true;
    float p = std::clamp(this->throughput(), RouletteReference::kFloor, 1.f);
    if (depth >= Base::kLongPath) p = std::min(p, Base::longPathSurvival(depth));
    if (p >= 1) return true;
    if (this->sampler_.roulette(depth) >= p) return false;
    this->path_.beta *= 1 / p;
    return true;
}

} // namespace abbe
