// The path tracer: one path from the camera. Estimators follow [Veach1997, ch. 8-10] for multiple importance sampling
// and [Wilkie2014] for the wavelengths; notation of docs/conventions.md.
#pragma once

#include "path_tracing/directed_bsdf.h"
#include "path_tracing/emission.h"
#include "path_tracing/guided_distance.h"
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
    template <typename Follow> MediumCollision passMedia(const MediaLeg&, std::uint32_t depth, Follow);
    void meetSurface(SurfaceHit&, Vec3 direction, std::uint32_t depth);
    const Bsdf& bsdfAt(const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    const Bsdf& mixedAt(const Bsdf& own, const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    std::optional<BsdfSample> sampleGuided(const SurfaceHit&, const Bsdf&, const EyeDirection&, const VertexSample&);
    float indexBeyond(const SurfaceHit&, Vec3 direction) const;
    void standAt(const SurfaceHit&, const Bsdf&, const EyeDirection&);
    std::optional<BsdfSample> sampleBsdf(const SurfaceHit&, const Bsdf&, const EyeDirection&, const VertexSample&);
    [[gnu::always_inline]] bool scatter(const SurfaceHit&, const BsdfSample&, const EyeDirection&, Ray&);
    bool scatterInMedium(Ray&, std::uint32_t depth);
    void samplePhase(Ray&, const VertexSample&, std::uint32_t depth);
    float turn(Ray&, const PhaseFunction&, const VertexSample&, std::uint32_t depth);
    bool leavesBySurface(const PhaseFunction&) const;
    void pullToSurface(const VertexSample&, Vec3 before, float& cosine, Vec3& direction);
    bool survives(std::uint32_t depth, float rouletteScale);

    Walk walk_;
    CameraVertex last_;
    float expected_ = 1; // radiance where it goes on to, over that of the frame in the mean
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
        const Arrival arrival = walk_.arrive(
            ray, hit, depth, [&](const MediaLeg& leg, auto follow) { return passMedia(leg, depth, follow); });
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
        const auto next = sampleBsdf(hit, bsdf, eye, sample);
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
MediumCollision CameraPath<E>::passMedia(const MediaLeg& leg, std::uint32_t depth, Follow follow) {
    setWork(Work::lights);
    nee_.alongRay(leg.ray, leg.tMax(), depth, leg.crossings);
    setWork(Work::surface);
    typename Emission<E>::OfMedia emission(walk_, last_, leg.ray);
    const RadianceCache* cache = walk_.context.distances;
    const MediumCollision collision =
        cache && !walk_.path.pull.pending ? GuidedDistance<E>(walk_, *cache, leg).choose(emission) : follow(&emission);
    nee_.collideAt(collision.t);
    return collision;
}

// What shading needs to know of the path, and what the surface gives off.
template <EffectBits E>
void CameraPath<E>::meetSurface(SurfaceHit& hit, Vec3 direction, [[maybe_unused]] std::uint32_t depth) {
    if constexpr (kTextures || Walk::kInterfaces) hit.arrival = direction;
    // Beside samples of the light, which are points, light is looked up at points: the two must see the same.
    if constexpr (kTextures) hit.footprint = walk_.path.delta ? walk_.path.cone.radius : 0;
    if (walk_.estimate.observer) [[unlikely]] {
        if constexpr (kMedia)
            if (const SurfacePull& pull = walk_.path.pull; pull.medium)
                walk_.estimate.observer->walked(*pull.medium, pull.likelihood());
        walk_.estimate.observer->arrives(hit, walk_.path.beta);
    }
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
    return walk_.context.mixes() ? mixedAt(own, hit, direction, depth) : own;
}

// What stands for the scattering at a surface some of whose directions are drawn evenly (LoopTechnique::evenly), or
// where a guide is asked: at surfaces that are not so glossy that they know better where to go.
template <EffectBits E>
const Bsdf& CameraPath<E>::mixedAt(const Bsdf& own, const SurfaceHit& hit, Vec3 direction, std::uint32_t depth) {
    const PathContext& context = walk_.context;
    if (context.how.evenly) [[unlikely]]
        return *walk_.arena.template make<DefensiveBsdf>(own, indexBeyond(hit, direction),
                                                         context.how.evenShare(depth));
    const Lobes lobes = own.lobes();
    const bool asks = lobes.has(Lobe::diffuse) && !lobes.has(Lobe::dispersive);
    walk_.path.ownPdf = 0;
    last_.guide = asks ? context.guide->at(hit.p, faceAgainst(direction, hit.shading.z)) : PathGuide::View();
    return own;
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
inline std::optional<BsdfSample> CameraPath<E>::sampleBsdf(const SurfaceHit& hit, const Bsdf& bsdf,
                                                           const EyeDirection& eye, const VertexSample& sample) {
    if (last_.guide.guided() > 0) return sampleGuided(hit, bsdf, eye, sample);
    auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
    if constexpr (kTextures)
        if (walk_.context.how.evenly && next) [[unlikely]]
            walk_.path.ownPdf = static_cast<const DefensiveBsdf&>(bsdf).ownDensity(eye.wo, next->wi);
    return next;
}

template <EffectBits E>
std::optional<BsdfSample> CameraPath<E>::sampleGuided(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye,
                                                      const VertexSample& sample) {
    const float eta = indexBeyond(hit, -eye.woRender);
    const auto [next, ownPdf, radiance] =
        GuidedSample::of(last_.guide, bsdf, hit.shading, eta, eye.wo, sample.lobe, sample.bsdf);
    walk_.path.ownPdf = ownPdf;
    expected_ = radiance;
    return next;
}

template <EffectBits E>
inline bool CameraPath<E>::scatter(const SurfaceHit& hit, const BsdfSample& next, const EyeDirection& eye, Ray& ray) {
    if (!walk_.scatter(hit, next, eye, ray)) return false;
    last_.origin = ray.origin;
    if (last_.guide && !(last_.guide.guided() > 0) && !walk_.path.delta)
        expected_ = last_.guide.look(ray.direction).radiance;
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
    if (const PathGuide* guide = walk_.context.guide) last_.guide = guide->at(ray.origin, kInMedium);
    if (last_.lit) {
        setWork(Work::lights);
        nee_.inMedium(ray.origin, ray.direction, sample, depth);
        setWork(volumeWork(medium.number));
    }
    samplePhase(ray, sample, depth);
    if (!anyNonZero(path.beta)) return false; // a direction of the guide in which nothing is scattered
    if constexpr (kLightPaths) caustics_.scatterInMedium(depth);
    if constexpr (kTextures) walk_.widenCone();
    last_.origin = ray.origin;
    ++counts.scattered;
    return true;
}

// Phase functions are sampled exactly, so that their weight is 1 but for wavelengths and for directions from elsewhere.
template <EffectBits E> void CameraPath<E>::samplePhase(Ray& ray, const VertexSample& sample, std::uint32_t depth) {
    auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    const PhaseFunction& phase = walk_.collided->phase();
    const FaultSource source{walk_.collided, "phase function"};
    const float cosine = turn(ray, phase, sample, depth);
    if (!(std::abs(cosine) < 1.001f)) estimate.dropSample(cosine, source);
    last_.receiver = ray.origin;
    last_.scatters.outline.count = 0;
    const float own = phase.value(cosine);
    estimate.checkDensity(own, source);
    path.bsdfPdf = walk_.context.how.mixedDensity(own, depth);
    path.ownPdf = 0;
    expected_ = 1;
    if (last_.guide) {
        const PathGuide::Direction seen = last_.guide.look(ray.direction);
        path.bsdfPdf = last_.guide.mixed(own, seen.pdf);
        expected_ = seen.radiance;
    }
    if (walk_.context.mixes() && path.bsdfPdf > 0) [[unlikely]] {
        path.ownPdf = own;
        path.beta *= own / path.bsdfPdf;
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
    if (estimate.observer) [[unlikely]]
        estimate.observer->turns(ray.direction, phase, own, path.bsdfPdf, path.beta);
    ray.kind = RayKind::scattered;
}

// A direction by the phase function, an even one, one of the guide or one towards the surface; its cosine with the one
// before.
template <EffectBits E>
float CameraPath<E>::turn(Ray& ray, const PhaseFunction& phase, const VertexSample& sample, std::uint32_t depth) {
    const LoopTechnique& how = walk_.context.how;
    const Vec3 before = ray.direction;
    if (sample.lobe < last_.guide.guided()) {
        ray.direction = last_.guide.sample(sample.bsdf).w;
        return std::clamp(dot(before, ray.direction), -1.f, 1.f);
    }
    const float even = how.evenly ? how.evenShare(depth) : 0;
    float cosine = sample.lobe < even ? 1 - 2 * sample.bsdf.x : phase.sampleCosine(sample.bsdf.x);
    ray.direction = directionAbout(before, cosine, sample.bsdf.y);
    if (!last_.guide && leavesBySurface(phase)) pullToSurface(sample, before, cosine, ray.direction);
    return cosine;
}

// Walks from where no light is sampled end where they leave the solid.
template <EffectBits E> bool CameraPath<E>::leavesBySurface(const PhaseFunction& phase) const {
    return !last_.lit && !walk_.context.how.evenly && SurfacePull::suits(phase) &&
           walk_.media.tracker.even(walk_.path.nested.here.media());
}

template <EffectBits E>
void CameraPath<E>::pullToSurface(const VertexSample& sample, Vec3 before, float& cosine, Vec3& direction) {
    SurfacePull& pull = walk_.path.pull;
    if (pull.medium != walk_.collided) {
        const PulledShares* shares = walk_.context.pulled;
        const float share = shares ? shares->of(*walk_.collided) : PulledShares::kUnknown;
        pull.begin(*walk_.collided, walk_.path.lambda, share, sample.lobe < share);
    }
    if (!pull.mixes()) return;
    if (pull.pulls()) {
        direction = directionAbout(pull.n, pull.drawCosine(sample.bsdf.x), sample.bsdf.y);
        cosine = std::clamp(dot(before, direction), -1.f, 1.f);
    }
    pull.take(dot(pull.n, direction), walk_.collided->phase().value(cosine));
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
