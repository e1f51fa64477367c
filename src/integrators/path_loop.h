// The one path loop. Estimators follow [Veach1997, ch. 8–10] for multiple importance sampling and [Wilkie2014] for
// the wavelengths; notation of docs/conventions.md.
#pragma once

#include "base/arena.h"
#include "base/work.h"
#include "integrators/defensive_bsdf.h"
#include "integrators/forced_lobe.h"
#include "integrators/hidden_face.h"
#include "integrators/leg_listener.h"
#include "integrators/path_context.h"
#include "integrators/path_counters.h"
#include "integrators/path_state.h"
#include "math/warp.h"
#include "render/light_vertex.h"
#include "render/path_observer.h"
#include "render/scene.h"
#include "transport/medium_tracker.h"
#include "transport/roulette.h"
#include "transport/sampler.h"
#include "transport/surroundings.h"

namespace abbe {

struct TracedView;

// What paths through media need and keep from one to the next.
struct MediaState {
    MediaState(const Scene& scene, const StopFlag& stop) : tracker(scene.openMedia, stop) {}
    bool left() const { return tracker.counters.left; } // a ray, since the render is to end

    // The way that the path is on, from a vertex or a boundary; `media` is empty where near lights are not looked for.
    struct Leg {
        Ray ray;
        RayExtent media;
        float collision = 0; // where it ended
    };

    MediumTracker tracker;
    Leg leg;
    std::vector<InScattering> inScattering;
};

// Radiance along one camera ray at the path's wavelengths.
template <EffectBits E> class PathLoop {
  public:
    // From here on no path is certain to go on.
    static constexpr std::uint32_t kLongPath = 64;

    static constexpr bool kMedia = hasEffect(E, Effect::media);
    static constexpr bool kInterfaces = hasEffect(E, Effect::interfaces);
    static constexpr bool kTextures = hasEffect(E, Effect::textures);
    static constexpr bool kTraced = hasEffect(E, Effect::lightPaths);
    static_assert(!kTraced || (kInterfaces && kTextures && hasEffect(E, Effect::dispersion)),
                  "light paths go through everything");
    static_assert(kInterfaces || !kMedia, "media are entered and left as dielectrics are");
    // No path is longer: with these probabilities of survival a path of this length has a probability below any
    // machine's patience only if everything reflects everything; such paths are counted, never silent. In a white
    // medium paths of several times the square of its optical radius still carry light.
    static constexpr std::uint32_t kMaxVertices = kMedia ? 1'000'000 : 100'000;
    // In a dense white medium more than n collisions have a probability of about n^(-1/2) up to the square of its
    // optical radius. Against a constant 0.999 a hundredth of the light, that of the longest paths, would hardly ever
    // be seen; survival to n in proportion to n^(-3/4) leaves the variance finite, and a path that can never leave
    // still has only some 9000 vertices.
    static float longPathSurvival(std::uint32_t depth) {
        return kMedia ? std::max(0.999f, 1 - 0.75f / static_cast<float>(depth)) : 0.999f;
    }
    using Media = std::conditional_t<kMedia, MediaState, path_detail::Nothing>;

    static Media makeMedia([[maybe_unused]] const Scene& scene, [[maybe_unused]] const StopFlag& stop = kNeverStop) {
        if constexpr (kMedia)
            return Media(scene, stop);
        else
            return {};
    }

    PathLoop(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters, Media& media)
        : context_(context), sampler_(sampler), arena_(arena), counters_(counters), media_(media) {}

    // To be called before radiance(). Somebody watches, or nobody (null):
    void watch(PathObserver* observer) { observer_ = observer; }
    // The camera ray is that of the hero alone:
    void startWithHero() { startWithHero_ = true; }
    // The camera is immersed:
    void startIn(const Surroundings& around) requires(kInterfaces) { path_.nested.here = around; }
    // The camera ray is a cone:
    void startWith(const path_detail::Cone& cone) requires(kTextures) { path_.cone = cone; }
    // Light paths bring light, too: requires the camera's ray in the view, and its query without a point.
    void weighAgainst(TracedView& view) requires(kTraced) { tracedView_ = &view; }
    // Glints that are probed are left out: those of the row of the pixel, and where on the film the path starts.
    void leaveOut(std::span<const std::uint32_t> glintsOfRow, Vec2 film) requires(kTraced) {
        path_.traced.glintsOfRow = glintsOfRow;
        path_.traced.film = film;
    }
    // `rouletteScale` of the pixel, see RouletteReference. Lanes at fault are negative or not finite.
    Spectrum radiance(Ray ray, const Wavelengths& lambda, float rouletteScale);
    // Of the last path: the least that any of the light in it came to, per lane; 0 at most. Without media, in which
    // paths may subtract light, its radiance tells.
    const Spectrum& least() const requires(kMedia) { return path_.least; }

  protected: // what paths do in either direction (light_loop.h)
    static constexpr bool kDispersion = hasEffect(E, Effect::dispersion);
    static constexpr bool kAbsorption = hasEffect(E, Effect::absorption);
    // Towards the eye, in the shading frame and in render space.
    struct Directions {
        Vec3 wo;
        Vec3 woRender;
    };

    bool toldToLeave(std::uint32_t count), leavesIfTold(); // path_loop_throughput.h
    void cap(const SurfaceHit*);
    float longSurvival(std::uint32_t depth);
    // Where a ray ended.
    enum class Arrival : std::uint8_t { surface, collision, nowhere };

    void countRay() {
        ++counters_.vertices;
        if constexpr (kDispersion) counters_.effects.heroRays += path_.densities.heroOnly;
        if constexpr (kMedia) counters_.effects.untouched += !touched_;
    }
    Arrival arrive(Ray&, SurfaceHit&, std::uint32_t depth);
    Arrival arriveThrough(Ray&, SurfaceHit&, std::uint32_t depth);
    bool collides(Ray&, const SurfaceHit* ahead, RandomStream&, std::uint32_t depth, std::uint32_t crossings);
    float straightOn(SurfaceHit&, const Ray&, path_detail::Nested&);
    void meetSurface(SurfaceHit&, Vec3 direction, std::uint32_t depth);
    void turnCone(const SurfaceHit&, const BsdfSample&, float cosine);
    void scatterCone();
    bool scatterInMedium(Ray&, std::uint32_t depth);
    void touch(const Medium&);
    class GlowCollector;
    void sampleNearLight(const Ray&, float tMax, std::uint32_t depth, std::uint32_t crossings);
    std::optional<EquiangularDistances> distancesTowards(const Light&) const;
    float trackingShare(const PickedLight&);
    void sampleLightInMedium(Vec3 p, Vec3 direction, const VertexSample&, std::uint32_t depth);
    Spectrum transmittance(Vec3 origin, const LightSample&, path_detail::Nested, RandomStream,
                           RayKind = RayKind::shadow);
    Spectrum clearness(const Surroundings&, float distance) const;
    // Light that reached the eye from a Light or a MediumEmission.
    void gather(const Spectrum& light, const void* source, bool passing = false) {
        gather(light, source, passing, [] {});
    }
    // `tell` is what an observer is told before.
    template <typename Tell> void gather(const Spectrum& light, const void* source, bool passing, Tell tell) {
        path_.radiance += light;
        path_.least = min(light, path_.least); // in this order NaN leaves it alone
        if (observer_) [[unlikely]] {
            tell();
            observer_->gathers(light, source, passing);
        }
    }
    // Numbers that a sample's light hides: what is divided by them, or chosen by them, is finite and positive again.
    // path_loop_faults.h
    struct Blame {
        const void* who = nullptr; // null: other events tell
        const char* what = "";
    };
    void checkDensities(float a, float b, Blame blame = {});
    void checkDensity(float pdf, Blame blame = {}) { checkDensities(pdf, 0, blame); }
    void checkRatios(const Spectrum&);
    void checkWeight(const Spectrum&, Blame blame = {});
    void checkDirection(Vec3 w, Blame blame = {}) {
        if (!(lengthSquared(w) < 2)) [[unlikely]]
            condemn(dot(w, w), blame);
    }
    void condemn(float fault, Blame);
    void meetLight(const SurfaceHit&, Vec3 direction);
    void leaveScene(const Ray&);
    void sampleLight(const SurfaceHit&, const Bsdf&, const Directions&, const VertexSample&, std::uint32_t depth);
    [[gnu::always_inline]] bool scatter(const SurfaceHit&, const BsdfSample&, const Directions&, Ray&);
    [[gnu::cold]] const Bsdf* evenly(const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    bool survives(std::uint32_t depth, float rouletteScale);
    bool occluded(Vec3 origin, const LightSample& light, RayKind kind = RayKind::shadow) const {
        const Intersector& world = *context_.scene.intersector;
        return light.distance < kInfinity ? world.occluded(origin, light.p, path_.time, kind)
                                          : world.occluded({origin, light.wi, kInfinity, path_.time, kind});
    }
    // path_loop_hidden.h
    float clearWay(Vec3 origin, Vec3 direction, float tMax, RayKind) const;
    bool arrivesAlike(const SurfaceHit&, Vec3 direction) const;
    bool arrivesAlike(const Ray&, float t) const;
    void hideFromScattering(LightSample&, const Light&, Vec3 origin) const;
    void absorb(const SurfaceHit&, Vec3 direction, float distance);
    // Throughput of the path so far, whatever lane made it.
    float throughput() const;
    // What a ray that crosses the surface towards `w` runs in; null in air.
    static const Curve* absorptionBeyond(const SurfaceHit& hit, Vec3 w) {
        return dot(w, hit.ng) < 0 ? hit.material->absorption() : nullptr;
    }
    void endSecondaryWavelengths();
    // A vertex as lights see it. What does not let light through is lit from the side of the eye alone.
    static Receiver receiver(const SurfaceHit& hit, const Bsdf& bsdf, const Directions& eye) {
        const Vec3 n = hit.shading.z;
        return {hit.p, eye.wo.z < 0 ? -n : n, bsdf.lobes().has(Lobe::transmission)};
    }
    void viewLobes(const Bsdf& bsdf, const Directions& eye) {
        path_.scatters.outline.count = 0;
        if (bsdf.lobes().has(Lobe::glossy)) path_.scatters = {eye.woRender, bsdf.outline(eye.wo)};
    }
    // False where the shading normal would let light through a surface or keep it from crossing one.
    static bool sidesAgree(const SurfaceHit&, const Directions&, Vec3 wi, Vec3 wiRender);
    // 1 / mean of the spectral balance heuristic for a contribution found by scattering, when next-event estimation
    // would have found it with density `lightPdf` (0: could not).
    float scatteringWeight(float lightPdf) const {
        if constexpr (kDispersion) return scatteringWeight(lightPdf, path_.densities.unidirectional);
        return scatteringWeight(lightPdf, Spectrum(1.f));
    }
    // The same where the path's densities have come to be `unidirectional`.
    float scatteringWeight(float lightPdf, const Spectrum& unidirectional) const;
    // The same for a contribution found on a light with density `lightPdf`, when the BSDF's is `eval`.
    float lightWeight(float lightPdf, const BsdfEval& eval, bool delta) const;
    // Of what scattering found and what was asked for, against everything that would have found it, too. `ends` gives
    // what metWeight() asks for.
    template <typename Ends> float foundWeight(float lightPdf, [[maybe_unused]] Ends ends) const {
        if constexpr (kTraced)
            if (path_.traced.weighs) return metWeight(lightPdf, ends());
        return path_.delta ? scatteringWeight(0) : scatteringWeight(lightPdf);
    }
    float askedWeight(const LightSample& light, const PickedLight& picked, const BsdfEval& eval,
                      [[maybe_unused]] Vec3 woRender) {
        if constexpr (kTraced)
            if (path_.traced.odds > 0)
                if (const auto weight = askedAgainstTraced(light, picked, woRender)) return *weight;
        return lightWeight(picked.probability * light.pdfSolidAngle, eval, light.delta);
    }

    // path_loop_manifold.h
    void askManifold(const SurfaceHit&, const Bsdf&, const Directions&, std::uint32_t depth);
    void askForChain(const SurfaceHit&, const Bsdf&, const Directions&, std::uint32_t depth, float share,
                     RandomStream&);
    void followChain(const SurfaceHit&, const BsdfSample&, Vec3 direction);
    template <typename Met> bool covered(Met met) const; // met() makes the LightTarget
    // path_loop_merge.h
    void meetGathering(const SurfaceHit&, const Bsdf&, std::uint32_t depth);
    void meetGatheringInMedium(std::uint32_t depth);
    bool merged(const Light*) const; // of a light that is met
    // path_loop_glints.h
    void meetGlint(const Bsdf&, const Directions&, const BsdfSample& next);
    bool probed(const Light*) const; // of a light that is met
    // path_loop_traced.h
    void beginTraced(Vec3 p);
    void arriveTraced(const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    LightVertex tracedVertex(Vec3 wi);
    void turnTraced(const BsdfSample&, const Directions&, Vec3 direction);
    void turnTracedInMedium();
    double tracedMean(const Spectrum&) const;
    float metWeight(float lightPdf, double ends) const;
    double askedEnds(const LightSample&, const PickedLight&, Vec3 p) const;
    float askedShare(double asked, double met, double traces) const;
    std::optional<float> askedAgainstTraced(const LightSample&, const PickedLight&, Vec3 woRender);
    float askedInMedium(const LightSample&, const PickedLight&, Vec3 p, float phase) const;

    const PathContext& context_;
    Sampler& sampler_;
    Arena& arena_;
    PathCounters& counters_;
    Media& media_;
    PathState<E> path_;
    [[no_unique_address]] std::conditional_t<kTraced, TracedView*, path_detail::Nothing> tracedView_{};
    PathObserver* observer_ = nullptr;
    bool startWithHero_ = false;
    LegListener* legs_ = nullptr;      // it has all light along the way: lights near it are not looked for
    const Medium* collided_ = nullptr; // after Arrival::collision
    bool touched_ = false;             // some medium scattered the path
    float ownPdf_ = 0; // of directions drawn evenly: the density that surface or medium would have; else 0
};

template <EffectBits E> Spectrum PathLoop<E>::radiance(Ray ray, const Wavelengths& lambda, float rouletteScale) {
    setWork(Work::surface);
    path_.lambda = lambda;
    path_.time = ray.time;
    if constexpr (kDispersion) {
        path_.densities.film = lambda;
        if (startWithHero_) endSecondaryWavelengths();
    }
    const std::uint32_t maxDepth = context_.settings.maxDepth ? context_.settings.maxDepth : kMaxVertices;
    SurfaceHit hit;
    for (std::uint32_t depth = 0;; ++depth) {
        countRay();
        const Arrival arrival = arrive(ray, hit, depth);
        if (arrival == Arrival::nowhere) {
            setWork(Work::lights);
            leaveScene(ray);
            break;
        }
        if (arrival == Arrival::surface) meetSurface(hit, ray.direction, depth);
        if (depth >= maxDepth) {
            if (context_.settings.maxDepth == 0) cap(arrival == Arrival::collision ? nullptr : &hit);
            break;
        }
        if constexpr (kMedia) {
            if (arrival == Arrival::collision) {
                if (!scatterInMedium(ray, depth) || !survives(depth, rouletteScale)) break;
                continue;
            }
        }
        arena_.reset();
        const Bsdf& bsdf =
            context_.how.evenly ? *evenly(hit, ray.direction, depth) : *hit.material->bsdf(hit, path_.lambda, arena_);
        const Directions eye{hit.shading.toLocal(-ray.direction), -ray.direction};
        path_.from = receiver(hit, bsdf, eye);
        if (context_.lights.asksForLobes()) viewLobes(bsdf, eye);
        const VertexSample sample = sampler_.vertex(depth);
        // Drawn before the shadow ray, so that the two chains of arithmetic overlap in the processor.
        const auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
        if constexpr (kTextures)
            if (context_.how.evenly && next) [[unlikely]]
                ownPdf_ = static_cast<const DefensiveBsdf&>(bsdf).ownDensity(eye.wo, next->wi);
        if (observer_) [[unlikely]]
            observer_->scatters(hit, bsdf.lobes(), path_.beta, next ? &*next : nullptr);
        setWork(Work::lights);
        sampleLight(hit, bsdf, eye, sample, depth);
        if constexpr (kTraced) {
            askManifold(hit, bsdf, eye, depth);
            meetGathering(hit, bsdf, depth);
            if (next) meetGlint(bsdf, eye, *next);
        }
        setWork(Work::surface);
        if (!next || !scatter(hit, *next, eye, ray) || !survives(depth, rouletteScale)) break;
    }
    if constexpr (kMedia) return path_.radiance;
    // Lanes in which any of the light was negative show it, even if the sum does not.
    return Spectrum(_mm256_blendv_ps(path_.radiance.v, path_.least.v, path_.least.v));
}

// What shading needs to know of the path, and what the surface gives off.
template <EffectBits E>
void PathLoop<E>::meetSurface(SurfaceHit& hit, Vec3 direction, [[maybe_unused]] std::uint32_t depth) {
    if constexpr (kTextures || kInterfaces) hit.arrival = direction;
    // Beside samples of the light, which are points, light is looked up at points: the two must see the same.
    if constexpr (kTextures) hit.footprint = path_.delta ? path_.cone.radius : 0;
    if (observer_) [[unlikely]]
        observer_->arrives(hit, path_.beta);
    if (hit.light) {
        const WorkScope work(Work::lights);
        meetLight(hit, direction);
    }
    if constexpr (kTextures) hit.footprint = path_.cone.radius;
    if constexpr (kTraced) arriveTraced(hit, direction, depth);
    if constexpr (kTextures)
        if (hit.material->bends()) hit.material->bend(hit);
}

template <EffectBits E>
bool PathLoop<E>::sidesAgree(const SurfaceHit& hit, const Directions& eye, Vec3 wi, Vec3 wiRender) {
    // A direction that is none agrees with nothing.
    const float geometrically = dot(eye.woRender, hit.ng) * dot(wiRender, hit.ng);
    return eye.wo.z * wi.z > 0 ? geometrically > 0 : geometrically <= 0;
}

template <EffectBits E>
inline bool PathLoop<E>::scatter(const SurfaceHit& hit, const BsdfSample& next, const Directions& eye, Ray& ray) {
    checkWeight(next.weight);
    path_.beta *= next.weight;
    path_.bsdfPdf = next.pdfSolidAngle;
    path_.delta = next.lobe.has(Lobe::delta);
    path_.etaScale *= next.eta * next.eta;
    if constexpr (kDispersion) {
        auto& d = path_.densities;
        if (path_.delta && next.lobe.has(Lobe::dispersive)) endSecondaryWavelengths();
        d.before = d.unidirectional;
        if (!path_.delta) checkRatios(next.pdfRatio);
        if (!path_.delta) d.unidirectional *= next.pdfRatio;
        if constexpr (kMedia) d.direction = d.unidirectional;
    }
    const Vec3 direction = hit.shading.toWorld(next.wi);
    if (!sidesAgree(hit, eye, next.wi, direction)) return checkDirection(direction), false;
    if constexpr (kTraced) {
        turnTraced(next, eye, direction);
        followChain(hit, next, direction);
    }
    if (next.lobe.has(Lobe::transmission)) {
        if constexpr (kInterfaces)
            path_.nested.here = path_.nested.beyond;
        else if constexpr (kAbsorption)
            path_.interior.absorption = absorptionBeyond(hit, direction);
    }
    if constexpr (kTextures) {
        turnCone(hit, next, eye.wo.z);
        scatterCone();
    }
    ray = {spawnOrigin(hit, direction), direction, kInfinity, path_.time};
    path_.origin = ray.origin;
    return anyNonZero(path_.beta);
}

} // namespace abbe

#include "integrators/path_loop_cone.h"
#include "integrators/path_loop_evenly.h"
#include "integrators/path_loop_faults.h"
#include "integrators/path_loop_glints.h"
#include "integrators/path_loop_hidden.h"
#include "integrators/path_loop_interfaces.h"
#include "integrators/path_loop_lights.h"
#include "integrators/path_loop_manifold.h"
#include "integrators/path_loop_media.h"
#include "integrators/path_loop_merge.h"
#include "integrators/path_loop_near_light.h"
#include "integrators/path_loop_throughput.h"
#include "integrators/path_loop_traced.h"
