// Camera paths that gather photons: by way of mirrors and clear glass, of media behind these and of what spreads light
// at the end.
#pragma once

#include "caustics/merging/photon_map.h"
#include "integrators/path_loop.h"

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
    void gather(Ray ray, const Wavelengths& lambda, const RoundPhotons& photons, float radius, Tell&& tell);

  private:
    // The way so far and what there is along it.
    template <typename Tell> class Legs final : public LegListener {
      public:
        Legs(GatherLoop& loop, const PhotonMap& photons, float radius, Tell& tell)
            : loop_(loop), photons_(photons), radius_(radius), tell_(tell) {}
        void goes(const Ray& ray, float tMax) override {
            if (loop_.depth_ > 0 && photons_.size() > 0) loop_.gatherAlong(ray, tMax, photons_, radius_, tell_);
        }

      private:
        GatherLoop& loop_;
        const PhotonMap& photons_;
        float radius_;
        Tell& tell_;
    };

    // Of the disk around a cone, m. In a focus of the cone it would vanish, and all light in it with it.
    float reach(float radius, const path_detail::Cone& cone, float way) const {
        return std::max(radius * std::max(cone.radius, leastSpread_ * way), this->context_.merging->leastRadius);
    }
    bool tooLong(const Photon& photon) const {
        const std::uint32_t most = this->context_.settings.maxDepth;
        return most > 0 && depth_ + 1 + photon.vertices > most;
    }
    template <typename Tell>
    void gatherAt(const SurfaceHit&, const Bsdf&, const typename Base::Directions&, const PhotonMap&, float radius,
                  Tell&& tell);
    template <typename Tell> void gatherAlong(const Ray&, float tMax, const PhotonMap&, float radius, Tell&& tell);
    // Radiance over the flux per area of the photon, without the scattering between.
    Spectrum joined(const Photon&) const;
    bool goesOn(std::uint32_t depth);

    std::uint32_t depth_ = 0;    // deltas so far
    std::uint32_t legCount_ = 0; // along which there were media
    float leastSpread_ = 0;
    Vec3 from_;     // of the last vertex
    float way_ = 0; // up to there, m
};

template <EffectBits E>
template <typename Tell>
void GatherLoop<E>::gather(Ray ray, const Wavelengths& lambda, const RoundPhotons& photons, float radius, Tell&& tell) {
    auto& path = this->path_;
    path.lambda = lambda;
    path.time = ray.time;
    path.densities.film = lambda;
    if (this->startWithHero_) this->endSecondaryWavelengths();
    leastSpread_ = 0.1f * path.cone.spread;
    Legs<std::remove_reference_t<Tell>> legs(*this, photons.inMedia, radius, tell);
    Base::legs_ = &legs;
    const auto& settings = this->context_.settings;
    const std::uint32_t most = settings.maxDepth ? settings.maxDepth : Base::kMaxVertices;
    SurfaceHit hit;
    for (depth_ = 0; depth_ < most; ++depth_) {
        this->countRay();
        from_ = ray.origin;
        const Vec3 direction = ray.direction;
        if (this->arrive(ray, hit, depth_) != Base::Arrival::surface || !anyNonZero(path.beta)) return;
        way_ += length(hit.p - from_);
        hit.arrival = direction;
        hit.footprint = path.cone.radius;
        if (hit.material->bends()) hit.material->bend(hit);
        this->arena_.reset();
        const Bsdf& bsdf = *hit.material->bsdf(hit, path.lambda, this->arena_);
        const typename Base::Directions eye{hit.shading.toLocal(-direction), -direction};
        const Lobes lobes = bsdf.lobes();
        if (depth_ > 0 && hit.material->reversible() && lobes.any(Lobes(Lobe::diffuse) | Lobe::glossy))
            gatherAt(hit, bsdf, eye, photons.onSurfaces, reach(radius, path.cone, way_), tell);
        if (!lobes.has(Lobe::delta)) return;
        const VertexSample sample = this->sampler_.vertex(depth_);
        const auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
        if (!next || !next->lobe.has(Lobe::delta)) return;
        if (!this->scatter(hit, *next, eye, ray) || !goesOn(depth_)) return;
    }
    if (settings.maxDepth == 0) this->cap(&hit);
}

template <EffectBits E>
template <typename Tell>
void GatherLoop<E>::gatherAt(const SurfaceHit& hit, const Bsdf& bsdf, const typename Base::Directions& eye,
                             const PhotonMap& photons, float radius, Tell&& tell) {
    photons.near(hit.p, radius, [&](const Photon& photon, float d2) {
        // Other sides and other surfaces nearby have light of their own.
        if (dot(photon.ng, hit.ng) < 0.5f || std::abs(dot(photon.p - hit.p, hit.ng)) > 0.5f * radius) return;
        if (tooLong(photon)) return;
        const Vec3 wi = hit.shading.toLocal(photon.wi);
        if (photon.followed && eye.wo.z * wi.z > 0) return; // manifold sampling has it
        if (!this->sidesAgree(hit, eye, wi, photon.wi)) return;
        const BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
        if (!anyNonZero(eval.fcos)) return;
        const DiskKernel over(d2 / square(radius), radius);
        // Flux is spread over the geometric surface, fcos has the cosine of the shading normal.
        const float facing = std::abs(dot(photon.wi, hit.ng));
        if (!(facing > 0)) return;
        tell(GatheredLight{photon, joined(photon) * photon.flux * eval.fcos * (over.value / facing), over.value,
                           over.closer, eval.pdfSolidAngle});
    });
}

// Photons stand for σ_s times the fluence. Along the way that integrates to the light that is scattered into it, less
// what is lost before it comes back here: only across the way it is blurred [Jarosz2008].
template <EffectBits E>
template <typename Tell>
void GatherLoop<E>::gatherAlong(const Ray& ray, float tMax, const PhotonMap& photons, float radius, Tell&& tell) {
    if constexpr (Base::kMedia) {
        constexpr std::uint32_t kNumbers = 0x30000000; // beyond those of vertices
        const auto& path = this->path_;
        MediumTracker& tracker = this->media_.tracker;
        const MediumStack& inside = path.nested.here.media();
        const RayExtent extent = tracker.extent(ray, tMax, inside);
        if (extent.empty()) return;
        const float way = way_ + length(ray.origin - from_);
        const auto reachAt = [&](float t) {
            path_detail::Cone cone = path.cone;
            cone.advance(t);
            return reach(radius, cone, way + t);
        };
        RandomStream random = this->sampler_.stream(kNumbers + legCount_++);
        photons.along(ray.origin, ray.direction, extent.tNear, extent.tFar, reachAt,
                      [&](const Photon& photon, float t, float d2) {
                          if (tooLong(photon) || !tracker.fills(*photon.medium, inside)) return;
                          const PhaseFunction& phase = photon.medium->phase();
                          const float cosine = dot(ray.direction, photon.wi), value = phase.value(cosine);
                          if (!(value > 0)) return;
                          const float r = reachAt(t);
                          const DiskKernel over(d2 / square(r), r);
                          Spectrum light = joined(photon) * photon.flux * (value * over.value);
                          if (phase.spectral()) light *= phase.ratio(cosine, path.lambda);
                          light *= tracker.transmittance(ray, t, inside, path.lambda, random);
                          light *= this->clearness(path.nested.here, t);
                          tell(GatheredLight{photon, light, over.value, over.closer, value});
                      });
    }
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
    if (depth >= Base::kLongPath) p = std::min(p, this->longSurvival(depth));
    if (p >= 1) return true;
    if (this->sampler_.roulette(depth) >= p) return false;
    this->path_.beta *= 1 / p;
    return true;
}

} // namespace abbe
