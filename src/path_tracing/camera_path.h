// The path tracer: one path from the camera. Estimators follow [Veach1997, ch. 8-10] for multiple importance sampling
// and [Wilkie2014] for the wavelengths; notation of docs/conventions.md.
#pragma once

#include "path_tracing/directed_bsdf.h"
#include "path_tracing/emission.h"
#include "path_tracing/next_event.h"
#include "transport/roulette.h"
#include "transport/walk.h"

namespace abbe {

// Radiance along one camera ray at the path's wavelengths.
template <EffectBits E> class CameraPath {
    using Walk = PathWalk<E>;
    static constexpr bool kMedia = Walk::kMedia, kTextures = Walk::kTextures, kLightPaths = Walk::kLightPaths;

  public:
    // What it is given outlives it. `observer`: who watches; null: nobody.
    CameraPath(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters,
               typename Walk::Media& media, PathObserver* observer = nullptr) requires(!kLightPaths)
        : walk_(context, sampler, arena, counters, media) {
        walk_.estimate.observer = observer;
    }
    CameraPath(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters,
               typename Walk::Media& media, PathObserver* observer, const CausticStart& start) requires(kLightPaths)
        : walk_(context, sampler, arena, counters, media), caustics_(walk_, start) {
        walk_.estimate.observer = observer;
    }
    CameraPath(const CameraPath&) = delete;
    CameraPath& operator=(const CameraPath&) = delete;

    // `heroOnly`: the ray is that of the hero alone. `rouletteScale` of the pixel, see RouletteReference. Lanes at
    // fault are negative or not finite.
    Spectrum radiance(Ray ray, const Wavelengths& lambda, float rouletteScale, bool heroOnly = false);
    // The least that any of the light in it came to, per lane; 0 at most. Without media, in which paths may subtract
    // light, its radiance tells.
    const Spectrum& least() const requires(kMedia) { return walk_.estimate.least; }

    // Whose start is set from outside.
    Walk& walk() { return walk_; }
    // NextEvent::weighBy().
    void weighLightBy(float worth) requires(kMedia) { nee_.weighBy(worth); }

  private:
    template <typename Follow>
    MediumCollision passMedia(const Ray&, float tMax, std::uint32_t depth, std::uint32_t crossings, Follow);
    void meetSurface(SurfaceHit&, Vec3 direction, std::uint32_t depth);
    const Bsdf& bsdfAt(const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    const Bsdf& mixedAt(const Bsdf& own, const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    float indexBeyond(const SurfaceHit&, Vec3 direction) const;
    void standAt(const SurfaceHit&, const Bsdf&, const EyeDirection&);
    std::optional<BsdfSample> sampleBsdf(const Bsdf&, const EyeDirection&, const VertexSample&);
    [[gnu::always_inline]] bool scatter(const SurfaceHit&, const BsdfSample&, const EyeDirection&, Ray&);
    bool scatterInMedium(Ray&, std::uint32_t depth);
    void samplePhase(Ray&, const VertexSample&, std::uint32_t depth);
    bool survives(std::uint32_t depth, float rouletteScale);

    Walk walk_;
    CameraVertex last_;
    const PathGuide::Region* region_ = nullptr; // that guides the path at the present vertex, if any
    float seen_ = 1;                            // radiance where the guide was looked up last
    float expected_ = 1;                        // radiance where it goes on to, over that of the frame in the mean
    [[no_unique_address]] CameraCaustics<E> caustics_;
    Emission<E> emission_{walk_, last_, caustics_};
    NextEvent<E> nee_{walk_, last_, caustics_};
};

template <EffectBits E>
Spectrum CameraPath<E>::radiance(Ray ray, const Wavelengths& lambda, float rouletteScale, bool heroOnly) {
    setWork(Work::surface);
    walk_.start(lambda, ray.time, heroOnly);
    const std::uint32_t maxDepth = walk_.maxDepth();
    SurfaceHit hit;
    for (std::uint32_t depth = 0;; ++depth) {
        const Arrival arrival =
            walk_.arrive(ray, hit, depth, [&](const Ray& leg, float tMax, std::uint32_t crossings, auto follow) {
                return passMedia(leg, tMax, depth, crossings, follow);
            });
        // Emission.
        if (arrival == Arrival::nowhere) {
            emission_.leaveScene(ray);
            break;
        }
        if (arrival == Arrival::surface) meetSurface(hit, ray.direction, depth);
        if (depth >= maxDepth) {
            walk_.endAtMaxDepth(arrival == Arrival::collision ? nullptr : &hit);
            break;
        }
        if constexpr (kMedia) {
            if (arrival == Arrival::collision) {
                if (!scatterInMedium(ray, depth) || !survives(depth, rouletteScale)) break;
                continue;
            }
        }
        const Bsdf& bsdf = bsdfAt(hit, ray.direction, depth);
        const EyeDirection eye{hit.shading.toLocal(-ray.direction), -ray.direction};
        standAt(hit, bsdf, eye);
        // BSDF sampling. Before the shadow ray, so that the two chains of arithmetic overlap in the processor.
        const VertexSample sample = walk_.sampler.vertex(depth);
        const auto next = sampleBsdf(bsdf, eye, sample);
        if (walk_.estimate.observer) [[unlikely]]
            walk_.estimate.observer->scatters(hit, bsdf.lobes(), walk_.path.beta, next ? &*next : nullptr);
        // Next-event estimation.
        setWork(Work::lights);
        nee_.atSurface(hit, bsdf, eye, sample, depth);
        if constexpr (kLightPaths) caustics_.sample(hit, bsdf, eye, depth, next ? &*next : nullptr);
        // Scattering and Russian roulette.
        setWork(Work::surface);
        if (!next || !scatter(hit, *next, eye, ray) || !survives(depth, rouletteScale)) break;
    }
    const RadianceEstimate& found = walk_.estimate;
    if constexpr (kMedia) return found.radiance;
    // Lanes in which any of the light was negative show it, even if the sum does not.
    return Spectrum(_mm256_blendv_ps(found.radiance.v, found.least.v, found.least.v));
}

// Between vertices: the light of media, and of lights near the ray.
template <EffectBits E>
template <typename Follow>
MediumCollision CameraPath<E>::passMedia(const Ray& ray, float tMax, std::uint32_t depth, std::uint32_t crossings,
                                         Follow follow) {
    setWork(Work::lights);
    nee_.alongRay(ray, tMax, depth, crossings);
    setWork(Work::surface);
    typename Emission<E>::OfMedia emission(walk_, last_, ray);
    const MediumCollision collision = follow(&emission);
    nee_.collideAt(collision.t);
    return collision;
}

// What shading needs to know of the path, and what the surface gives off.
template <EffectBits E>
void CameraPath<E>::meetSurface(SurfaceHit& hit, Vec3 direction, [[maybe_unused]] std::uint32_t depth) {
    if constexpr (kTextures || Walk::kInterfaces) hit.arrival = direction;
    // Beside samples of the light, which are points, light is looked up at points: the two must see the same.
    if constexpr (kTextures) hit.footprint = walk_.path.delta ? walk_.path.cone.radius : 0;
    if (walk_.estimate.observer) [[unlikely]]
        walk_.estimate.observer->arrives(hit, walk_.path.beta);
    if (hit.light) {
        const WorkScope work(Work::lights);
        emission_.addSurface(hit, direction);
    }
    if constexpr (kTextures) hit.footprint = walk_.path.cone.radius;
    if constexpr (kLightPaths) caustics_.lightPaths.arrive(hit, direction, depth);
    if constexpr (kTextures)
        if (hit.material->bends()) hit.material->bend(hit);
}

template <EffectBits E>
inline const Bsdf& CameraPath<E>::bsdfAt(const SurfaceHit& hit, Vec3 direction, std::uint32_t depth) {
    walk_.arena.reset();
    const Bsdf& own = *hit.material->bsdf(hit, walk_.path.lambda, walk_.arena);
    expected_ = 1;
    region_ = nullptr;
    return walk_.context.mixes() ? mixedAt(own, hit, direction, depth) : own;
}

// What stands for the scattering at a surface some of whose directions are drawn evenly (LoopTechnique::evenly), or by
// the guide, if it knows the place and the surface is not so glossy that it knows better where to go.
template <EffectBits E>
const Bsdf& CameraPath<E>::mixedAt(const Bsdf& own, const SurfaceHit& hit, Vec3 direction, std::uint32_t depth) {
    const PathContext& context = walk_.context;
    if (context.how.evenly) [[unlikely]]
        return *walk_.arena.template make<DefensiveBsdf>(own, indexBeyond(hit, direction),
                                                         context.how.evenShare(depth));
    if (!own.lobes().has(Lobe::diffuse) || own.lobes().has(Lobe::dispersive)) return own;
    region_ = context.guide->at(hit.p, faceAgainst(direction, hit.shading.z));
    if (!region_ || !(region_->guided > 0)) return own;
    return *walk_.arena.template make<GuidedBsdf>(
        own, indexBeyond(hit, direction), region_->guided,
        GuidedDirections{*context.guide, *region_, hit.p, hit.shading, &seen_});
}

// Index of the side away from where the path comes from over that of its own side.
template <EffectBits E> float CameraPath<E>::indexBeyond(const SurfaceHit& hit, Vec3 direction) const {
    const Curve* inside = hit.material->ior();
    if (!inside) return 1;
    const Wavelengths& lambda = walk_.path.lambda;
    float eta = inside->at(lambda)[0];
    if (hit.outside) eta /= hit.outside->at(lambda)[0];
    return dot(hit.shading.z, direction) > 0 ? 1 / eta : eta; // on the way out
}

// The vertex as lights see it. What does not let light through is lit from the side of the eye alone.
template <EffectBits E>
inline void CameraPath<E>::standAt(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye) {
    const Vec3 n = hit.shading.z;
    last_.receiver = {hit.p, eye.wo.z < 0 ? -n : n, bsdf.lobes().has(Lobe::transmission)};
    last_.lit = true;
    if (!walk_.context.lights.usesLobes()) return;
    last_.scatters.outline.count = 0;
    if (bsdf.lobes().has(Lobe::glossy)) last_.scatters = {eye.woRender, bsdf.outline(eye.wo)};
}

template <EffectBits E>
inline std::optional<BsdfSample> CameraPath<E>::sampleBsdf(const Bsdf& bsdf, const EyeDirection& eye,
                                                           const VertexSample& sample) {
    auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
    expected_ = seen_; // lights look it up, too, after that
    if constexpr (kTextures)
        if (walk_.context.mixes() && next) [[unlikely]] {
            const auto density = [&](const auto& mixed) { return mixed.ownDensity(eye.wo, next->wi); };
            walk_.path.ownPdf = walk_.context.how.evenly         ? density(static_cast<const DefensiveBsdf&>(bsdf))
                                : region_ && region_->guided > 0 ? density(static_cast<const GuidedBsdf&>(bsdf))
                                                                 : 0;
        }
    return next;
}

template <EffectBits E>
inline bool CameraPath<E>::scatter(const SurfaceHit& hit, const BsdfSample& next, const EyeDirection& eye, Ray& ray) {
    if (!walk_.scatter(hit, next, eye, ray)) return false;
    last_.origin = ray.origin;
    if (!region_ || walk_.path.delta)
        expected_ = 1;
    else if (!(region_->guided > 0))
        expected_ = walk_.context.guide->look(*region_, hit.p, ray.direction).radiance;
    if constexpr (kLightPaths) caustics_.scatter(hit, next, eye, ray.direction);
    return true;
}

// The vertex at the ray's origin.
template <EffectBits E> bool CameraPath<E>::scatterInMedium(Ray& ray, std::uint32_t depth) {
    auto& path = walk_.path;
    const Medium& medium = *walk_.collided;
    VolumeCounts& counts = walk_.counters.effects.volumes[volumeRow(medium.number)];
    // What the path does from here on it does because of the first medium that scattered it.
    if (!std::exchange(path.scatteredInMedium, true)) {
        ++counts.first;
        setWorkCause(static_cast<std::uint8_t>(1 + volumeRow(medium.number)));
    }
    if constexpr (kLightPaths)
        if (depth == 0) caustics_.lightPaths.begin(ray.origin);
    const WorkScope work(volumeWork(medium.number));
    if (!anyNonZero(path.beta)) return false;
    const VertexSample sample = walk_.sampler.vertex(depth);
    if (walk_.estimate.observer) [[unlikely]]
        walk_.estimate.observer->collides(ray.origin, path.beta);
    last_.lit = walk_.isLit(medium);
    if (last_.lit) {
        setWork(Work::lights);
        nee_.inMedium(ray.origin, ray.direction, sample, depth);
        setWork(volumeWork(medium.number));
    }
    samplePhase(ray, sample, depth);
    if constexpr (kLightPaths) caustics_.scatterInMedium(depth);
    if constexpr (kTextures) walk_.widenCone();
    last_.origin = ray.origin;
    ++counts.scattered;
    return true;
}

// Phase functions are sampled exactly, so that their weight is 1 but for wavelengths.
template <EffectBits E> void CameraPath<E>::samplePhase(Ray& ray, const VertexSample& sample, std::uint32_t depth) {
    auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    const LoopTechnique& how = walk_.context.how;
    const PhaseFunction& phase = walk_.collided->phase();
    const float even = how.evenly ? how.evenShare(depth) : 0;
    const float cosine = sample.lobe < even ? 1 - 2 * sample.bsdf.x : phase.sampleCosine(sample.bsdf.x);
    const FaultSource source{walk_.collided, "phase function"};
    if (!(std::abs(cosine) < 1.001f)) estimate.dropSample(cosine, source);
    last_.receiver = ray.origin;
    last_.scatters.outline.count = 0;
    path.bsdfPdf = phase.value(cosine);
    estimate.checkDensity(path.bsdfPdf, source);
    if (even > 0) [[unlikely]] {
        path.ownPdf = path.bsdfPdf;
        path.bsdfPdf = how.mixedDensity(path.ownPdf, depth);
        path.beta *= path.ownPdf / path.bsdfPdf;
    }
    path.delta = false;
    if (phase.spectral()) {
        const Spectrum ratio = phase.ratio(cosine, path.lambda);
        estimate.checkWeight(ratio, source);
        path.beta *= ratio;
    }
    if constexpr (Walk::kDispersion) {
        path.densities.before = path.densities.unidirectional;
        path.densities.direction = path.densities.unidirectional;
    }
    ray.direction = directionAbout(ray.direction, cosine, sample.bsdf.y);
    ray.kind = RayKind::scattered;
}

template <EffectBits E> bool CameraPath<E>::survives(std::uint32_t depth, float rouletteScale) {
    if (depth == 0) return true; // the first bounce carries most of the image
    const float scale = walk_.path.delta ? std::max(rouletteScale, walk_.context.how.leastAfterDelta) : rouletteScale;
    // A guide knows what is to be expected where the path goes [Vorba2016].
    float p = RouletteReference::survival(walk_.throughput(), scale * expected_);
    // Total reflection in a clear solid can trap a path that loses nothing. Close to 1, because roulette against an
    // albedo ρ has finite variance only for p > ρ².
    if (depth >= kLongPath) [[unlikely]]
        p = std::min(p, walk_.longSurvival(depth));
    return walk_.survives(depth, p);
}

// Compiled with its kernel (path_kernels.cpp); tests follow single rays by it.
extern template Spectrum CameraPath<kLoopEffects.bits()>::radiance(Ray, const Wavelengths&, float, bool);

} // namespace abbe
