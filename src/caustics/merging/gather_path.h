// Camera paths that gather photons: by way of mirrors and clear glass, of media behind these and of what spreads light
// at the end.
#pragma once

#include "caustics/merging/merge_plan.h"
#include "caustics/merging/photon_map.h"
#include "transport/roulette.h"
#include "transport/walk.h"

namespace abbe {

// What one photon adds to the picture.
struct GatheredLight {
    const Photon& photon;
    Spectrum value;      // radiance at the eye at the wavelengths of the path, over the number of photons
    float kernel = 0;    // 1/m², that is in it
    float closer = 0;    // times `value`: what it would be over half of the area
    float cameraPdf = 0; // 1/sr, of the photon's direction for a camera path at that place
};

// A camera path of MergePlan. It takes no other light.
template <EffectBits E> class GatherPath {
    using Walk = PathWalk<E>;
    static_assert(Walk::kLightPaths);

  public:
    using Media = typename Walk::Media;

    // What it is given outlives it.
    GatherPath(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters, Media& media)
        : walk_(context, sampler, arena, counters, media) {}

    // Whose start is set from outside.
    Walk& walk() { return walk_; }

    // `heroOnly`: the ray is that of the hero alone. Of photons of the same wavelengths and time, `radius` over that of
    // the path's cone, at least MergePlan's.
    template <typename Tell>
    void gather(Ray ray, const Wavelengths& lambda, bool heroOnly, const PhotonMaps& photons, float radius,
                Tell&& tell);

  private:
    // Of the disk around a cone, m. In a focus of the cone it would vanish, and all light in it with it.
    float reach(float radius, const RayCone& cone, float way) const {
        return std::max(radius * std::max(cone.radius, leastSpread_ * way), walk_.context.merging->leastRadius);
    }
    bool tooLong(const Photon& photon) const {
        const std::uint32_t most = walk_.context.settings.maxDepth;
        return most > 0 && depth_ + 1 + photon.vertices > most;
    }
    template <typename Tell>
    void gatherAt(const SurfaceHit&, const Bsdf&, const EyeDirection&, const PhotonMap&, float radius, Tell&& tell);
    template <typename Tell> void gatherAlong(const Ray&, float tMax, const PhotonMap&, float radius, Tell&& tell);
    // Radiance over the flux per area of the photon, without the scattering between.
    Spectrum joined(const Photon&) const;
    bool goesOn(std::uint32_t depth);

    Walk walk_;
    std::uint32_t depth_ = 0;    // deltas so far
    std::uint32_t legCount_ = 0; // along which there were media
    float leastSpread_ = 0;
    Vec3 from_;     // of the last vertex
    float way_ = 0; // up to there, m
};

template <EffectBits E>
template <typename Tell>
void GatherPath<E>::gather(Ray ray, const Wavelengths& lambda, bool heroOnly, const PhotonMaps& photons, float radius,
                           Tell&& tell) {
    auto& path = walk_.path;
    walk_.start(lambda, ray.time, heroOnly);
    leastSpread_ = 0.1f * path.cone.spread;
    const std::uint32_t most = walk_.maxDepth();
    SurfaceHit hit;
    for (depth_ = 0; depth_ < most; ++depth_) {
        from_ = ray.origin;
        const Vec3 direction = ray.direction;
        const Arrival arrival = walk_.arrive(ray, hit, depth_, [&](const MediaLeg& leg, auto follow) {
            setWork(Work::lights);
            if (depth_ > 0 && photons.inMedia.size() > 0)
                gatherAlong(leg.ray, leg.tMax(), photons.inMedia, radius, tell);
            return IgnoreMedia()(leg, follow);
        });
        if (arrival != Arrival::surface || !anyNonZero(path.beta)) return;
        way_ += length(hit.p - from_);
        hit.arrival = direction;
        hit.footprint = path.cone.radius;
        if (hit.material->bends()) hit.material->bend(hit);
        walk_.arena.reset();
        const Bsdf& bsdf = *hit.material->bsdf(hit, path.lambda, walk_.arena);
        const EyeDirection eye{hit.shading.toLocal(-direction), -direction};
        const Lobes lobes = bsdf.lobes();
        if (depth_ > 0 && hit.material->reversible() && lobes.any(Lobes(Lobe::diffuse) | Lobe::glossy))
            gatherAt(hit, bsdf, eye, photons.onSurfaces, reach(radius, path.cone, way_), tell);
        if (!lobes.has(Lobe::delta)) return;
        const VertexSample sample = walk_.sampler.vertex(depth_);
        const auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
        if (!next || !next->lobe.has(Lobe::delta)) return;
        if (!walk_.scatter(hit, *next, eye, ray) || !goesOn(depth_)) return;
    }
    walk_.endAtMaxDepth(&hit);
}

template <EffectBits E>
template <typename Tell>
void GatherPath<E>::gatherAt(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye, const PhotonMap& photons,
                             float radius, Tell&& tell) {
    photons.near(hit.p, radius, [&](const Photon& photon, float d2) {
        // Other sides and other surfaces nearby have light of their own.
        if (dot(photon.ng, hit.ng) < 0.5f || std::abs(dot(photon.p - hit.p, hit.ng)) > 0.5f * radius) return;
        if (tooLong(photon)) return;
        const Vec3 wi = hit.shading.toLocal(photon.wi);
        if (photon.followed && eye.wo.z * wi.z > 0) return; // manifold sampling has it
        if (!walk_.sidesAgree(hit, eye, wi, photon.wi)) return;
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
void GatherPath<E>::gatherAlong(const Ray& ray, float tMax, const PhotonMap& photons, float radius, Tell&& tell) {
    if constexpr (Walk::kMedia) {
        constexpr std::uint32_t kNumbers = 0x30000000; // beyond those of vertices
        const auto& path = walk_.path;
        MediumTracker& tracker = walk_.media.tracker;
        const MediumStack& inside = path.nested.here.media();
        const RayExtent extent = tracker.extent(ray, tMax, inside);
        if (extent.empty()) return;
        const float way = way_ + length(ray.origin - from_);
        const auto reachAt = [&](float t) {
            RayCone cone = path.cone;
            cone.advance(t);
            return reach(radius, cone, way + t);
        };
        RandomStream random = walk_.sampler.stream(kNumbers + legCount_++);
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
                          light *= walk_.clearness(path.nested.here, t);
                          tell(GatheredLight{photon, light, over.value, over.closer, value});
                      });
    }
}

// The balance of the wavelengths [Wilkie2014] over the whole path. Where one half belongs to the hero alone it counts
// eightfold already.
template <EffectBits E> Spectrum GatherPath<E>::joined(const Photon& photon) const {
    const auto& path = walk_.path;
    const Spectrum& own = path.densities.unidirectional;
    if (path.densities.heroOnly && photon.heroOnly) return path.beta * (1.f / static_cast<float>(kLanes));
    if (path.densities.heroOnly) return path.beta * (1 / photon.densities[0]);
    if (photon.heroOnly) return path.beta * (1 / own[0]);
    return path.beta * (1 / mean(own * photon.densities));
}

// Chains of deltas have no end in a hall of mirrors.
template <EffectBits E> bool GatherPath<E>::goesOn(std::uint32_t depth) {
    if (depth < 4) return true;
    float p = std::clamp(walk_.throughput(), RouletteReference::kFloor, 1.f);
    if (depth >= kLongPath) p = std::min(p, walk_.longSurvival(depth));
    return walk_.survives(depth, p);
}

} // namespace abbe
