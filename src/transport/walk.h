// What every path does, whichever end it starts from: it arrives at surfaces and in media, is scattered, dimmed, and
// ended by Russian roulette. Wavelengths as in [Wilkie2014]; notation of docs/conventions.md.
#pragma once

#include "base/arena.h"
#include "base/work.h"
#include "render/scene.h"
#include "transport/medium_tracker.h"
#include "transport/path_context.h"
#include "transport/path_state.h"
#include "transport/radiance_estimate.h"
#include "transport/sampler.h"
#include "transport/surroundings.h"

namespace abbe {

// What paths through media need and keep from one to the next.
struct MediaState {
    MediaState(const Scene& scene, const StopFlag& stop) : tracker(scene.openMedia, stop) {}
    bool left() const { return tracker.counters.left; } // a ray, since the render is to end

    MediumTracker tracker;
    std::vector<InScattering> inScattering;
};

// Where a ray ended.
enum class Arrival : std::uint8_t { surface, collision, nowhere };

// Towards the eye, in the shading frame and in render space.
struct EyeDirection {
    Vec3 wo;
    Vec3 woRender;
};

// A straight way through media.
struct MediaLeg {
    const Ray& ray;
    const SurfaceHit* ahead; // where it ends; null: nowhere
    std::uint32_t crossings; // of boundaries before it, from the last vertex on
    RandomStream& random;    // for what happens on it

    float tMax() const { return ahead ? ahead->distance : kInfinity; }
};

// For paths that look for nothing on their way through media. What these give off is listened to all the same, or such
// a path would have other random numbers than one that takes it.
struct IgnoreMedia {
    class IgnoredEmission final : public EmissionListener {
      public:
        void emits(const MediumEmission&, float, const Spectrum&, const Spectrum&, const Spectrum&) override {}
    };
    template <typename Follow> MediumCollision operator()(const MediaLeg&, Follow follow) const {
        setWork(Work::surface);
        IgnoredEmission unheard;
        return follow(&unheard);
    }
};

// Where a ray collides. So near to the surface in front that rounding might put it beyond, it is where rays spawn
// before that surface: outside of the shape whose interior it is in, a path would not find back.
inline Vec3 placeOfCollision(const Ray& ray, float t, const SurfaceHit* ahead) {
    const Vec3 p = ray.origin + ray.direction * t;
    if (!ahead) return p;
    constexpr float kRounding = 0x1p-22f;
    const Vec3 far = max(abs(ray.origin), abs(p)), error = ahead->pError + far * kRounding;
    const float depth = (ahead->distance - t) * std::abs(dot(ray.direction, ahead->ng));
    if (depth > error.x + error.y + error.z) return p;
    return spawnOrigin(*ahead, -ray.direction);
}

// A unit direction at an angle to another one; u in [0, 1) turns it around.
inline Vec3 directionAbout(Vec3 axis, float cosine, float u) {
    const float sine = safeSqrt((1 - cosine) * (1 + cosine)), azimuth = 2 * kPi * u;
    const Frame frame = Frame::fromNormal(axis);
    return normalize(frame.toWorld({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine}));
}

// One path. Estimators have one: CameraPath, LightPath, GatherPath and GlintPath; what only one of them does is theirs.
// E: the effects of the scene; nothing of the others is compiled.
template <EffectBits E> class PathWalk {
  public:
    static constexpr bool kAbsorption = hasEffect(E, Effect::absorption);
    static constexpr bool kDispersion = hasEffect(E, Effect::dispersion);
    static constexpr bool kMedia = hasEffect(E, Effect::media);
    static constexpr bool kInterfaces = hasEffect(E, Effect::interfaces);
    static constexpr bool kTextures = hasEffect(E, Effect::textures);
    static constexpr bool kLightPaths = hasEffect(E, Effect::lightPaths);
    static_assert(!kLightPaths || (kInterfaces && kTextures && kDispersion), "light paths go through everything");
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

    using Media = std::conditional_t<kMedia, MediaState, NoState>;
    static Media makeMedia([[maybe_unused]] const Scene& scene, [[maybe_unused]] const StopFlag& stop = kNeverStop) {
        if constexpr (kMedia)
            return Media(scene, stop);
        else
            return {};
    }

    // All outlive it.
    PathWalk(const PathContext& c, Sampler& s, Arena& a, PathCounters& n, Media& m)
        : context(c), sampler(s), arena(a), counters(n), media(m) {}

    // Before start(): what the first ray runs in, and how wide it is.
    void startIn(const Surroundings& around) requires(kInterfaces) { path.nested.here = around; }
    void startWith(const RayCone& cone) requires(kTextures) { path.cone = cone; }
    // `heroOnly`: the first ray is that of the hero alone.
    void start(const Wavelengths& lambda, float time, [[maybe_unused]] bool heroOnly = false) {
        path.lambda = lambda;
        path.time = time;
        if constexpr (kDispersion) {
            path.densities.film = lambda;
            if (heroOnly) endSecondaryWavelengths();
        }
    }

    // Goes on to the next collision or to the next surface that does anything to the path, through boundaries of media,
    // open surfaces, and faces of dielectrics that lie hidden inside others (surroundings.h). After a collision the ray
    // starts there. onTheWay(MediaLeg, follow), for each straight way through media, up to a surface, a boundary or the
    // end of everything: returns follow(EmissionListener*), which follows it to where it collides, or does as much.
    template <typename OnTheWay>
    Arrival arrive(Ray& ray, SurfaceHit& hit, std::uint32_t depth, [[maybe_unused]] OnTheWay&& onTheWay);
    Arrival arrive(Ray& ray, SurfaceHit& hit, std::uint32_t depth) { return arrive(ray, hit, depth, IgnoreMedia()); }

    // At a surface, in the sampled direction. False where the path ends.
    [[gnu::always_inline]] bool scatter(const SurfaceHit&, const BsdfSample&, const EyeDirection&, Ray&);
    // The direction just taken is a wide one: textures are averaged over more from here on.
    void widenCone();
    // The direction just taken belongs to the hero alone.
    void endSecondaryWavelengths();
    // False where the shading normal would let light through a surface or keep it from crossing one.
    static bool sidesAgree(const SurfaceHit&, const EyeDirection&, Vec3 wi, Vec3 wiRender);

    // Of everything between a vertex, around which that is, and a light: nothing behind a surface. `least`: as
    // MediumTracker::transmittance().
    Spectrum transmittance(Vec3 origin, const LightSample&, const Surroundings& around, RandomStream,
                           RayKind = RayKind::shadow, float least = 0);
    bool occluded(Vec3 origin, const LightSample& light, RayKind kind = RayKind::shadow) const {
        const Intersector& world = *context.scene.intersector;
        return light.distance < kInfinity ? world.occluded(origin, light.p, path.time, kind)
                                          : world.occluded({origin, light.wi, kInfinity, path.time, kind});
    }
    // Whether next-event estimation from within the medium could find anything: elsewhere it is not made, and nothing
    // is weighed against it.
    bool isLit(const Medium& medium) const { return context.scene.mediumUses[medium.number].lit; }
    // The same of all media of the shapes around the path.
    bool isLitHere() const {
        const MediumStack& around = path.nested.here.media();
        for (int i = 0; i < around.size(); ++i)
            if (!isLit(*around[i])) return false;
        return true;
    }
    // Of a clear absorbing dielectric, over a distance.
    Spectrum clearness(const Surroundings&, float distance) const;
    // What a ray that crosses the surface towards `w` runs in; null in air.
    static const Curve* absorptionBeyond(const SurfaceHit& hit, Vec3 w) {
        return dot(w, hit.ng) < 0 ? hit.material->absorption() : nullptr;
    }

    // Throughput of the path so far, whatever lane made it.
    float throughput() const;
    // Russian roulette: the path goes on with probability p, and then carries 1/p of its light.
    bool survives(std::uint32_t depth, float p) {
        if (p >= 1) return true;
        if (sampler.roulette(depth) >= p) return false;
        path.beta *= 1 / p;
        return true;
    }
    // Of long paths, at most. 0 where the render is to end. Out of line, so that short paths do not pay for it.
    [[gnu::noinline]] float longSurvival(std::uint32_t depth) {
        return toldToLeave(depth) ? 0 : longPathSurvival(depth);
    }
    // Vertices of a path, by the settings or by the cap.
    std::uint32_t maxDepth() const { return context.settings.maxDepth ? context.settings.maxDepth : kMaxVertices; }
    // A path has as many. At a surface, or else where it collided last.
    void endAtMaxDepth(const SurfaceHit* hit) {
        if (context.settings.maxDepth == 0) cap(hit);
    }

    const PathContext& context;
    Sampler& sampler;
    Arena& arena;
    PathCounters& counters;
    Media& media;
    PathState<E> path;
    RadianceEstimate estimate;
    const Medium* collided = nullptr; // after Arrival::collision

  private:
    void countRay() {
        ++counters.vertices;
        if constexpr (kDispersion) counters.effects.heroRays += path.densities.heroOnly;
        if constexpr (kMedia) counters.effects.untouched += !path.scatteredInMedium;
    }
    bool toldToLeave(std::uint32_t count), leavesIfTold();
    void cap(const SurfaceHit*);
    void absorb(const SurfaceHit&, Vec3 direction, float distance);
    void turnCone(const SurfaceHit&, const BsdfSample&, float cosine);
    template <typename OnTheWay> Arrival arriveThrough(Ray&, SurfaceHit&, std::uint32_t depth, OnTheWay&);
    template <typename OnTheWay>
    bool collides(Ray&, const SurfaceHit* ahead, RandomStream&, std::uint32_t crossings, OnTheWay&);
    bool findAhead(const Ray&, SurfaceHit&, const RandomStream&);
    float straightOn(SurfaceHit&, const Ray&, NestedDielectrics&);
};

template <EffectBits E>
template <typename OnTheWay>
Arrival PathWalk<E>::arrive(Ray& ray, SurfaceHit& hit, std::uint32_t depth, [[maybe_unused]] OnTheWay&& onTheWay) {
    countRay();
    if constexpr (kInterfaces) return arriveThrough(ray, hit, depth, onTheWay);
    if (!context.scene.intersector->intersect(ray, hit)) return Arrival::nowhere;
    if constexpr (kAbsorption) absorb(hit, ray.direction, hit.distance);
    if constexpr (kTextures) path.cone.advance(hit.distance);
    return Arrival::surface;
}

// The share of the light at a surface that goes straight on, which has then crossed it.
template <EffectBits E> float PathWalk<E>::straightOn(SurfaceHit& hit, const Ray& ray, NestedDielectrics& nested) {
    const Material& material = *hit.material;
    if (material.isBoundary()) {
        nested.here.cross(hit, ray.direction);
        return 1;
    }
    float open = 0;
    if (material.mayBeOpen()) {
        hit.arrival = ray.direction;
        if constexpr (kTextures) hit.footprint = path.cone.radius;
        const float opacity = material.opacity(hit);
        open = 1 - opacity;
        if (!(opacity >= 0 && opacity <= 1)) estimate.dropSample(opacity, {&material, "opacity"});
        if (open >= 1) return 1;
    }
    if (material.ior()) {
        if (!isHiddenFace(context.scene, hit, ray, nested.here, nested.beyond)) return open;
        nested.here = nested.beyond;
        return 1;
    }
    hit.outside = nested.here.ior();
    nested.beyond = nested.here;
    nested.beyond.cross(hit, ray.direction);
    return open;
}

// The surface ahead, unless the path is certain to collide before it (`random`: what its tracking will use): in dense
// media nearly all rays end long before. So near to the collision that placeOfCollision() may ask for it, a surface is
// found all the same, but at a grazing angle at which no ray could reach it.
template <EffectBits E>
bool PathWalk<E>::findAhead(const Ray& ray, SurfaceHit& hit, [[maybe_unused]] const RandomStream& random) {
    const Intersector& world = *context.scene.intersector;
    if constexpr (kMedia) {
        const Surroundings& here = path.nested.here;
        // What looks for lights along the ray must know its end, as must what draws distances by what is there.
        if (!path.delta && !here.absorption() && !context.distances) {
            const float t = media.tracker.reach(ray, here.media(), path.lambda, random, path.pull.stretch());
            if (t < kInfinity) {
                constexpr float kMargin = 0x1p-13f; // of the place's distance from the origin: 500 times its rounding
                Ray piece = ray;
                piece.tMax = t + kMargin * (t + length(ray.origin));
                return world.intersect(piece, hit);
            }
        }
    }
    return world.intersect(ray, hit);
}

// Follows the ray up to the surface ahead, if any; true if the path collided on the way, where the ray then starts.
template <EffectBits E>
template <typename OnTheWay>
bool PathWalk<E>::collides(Ray& ray, const SurfaceHit* ahead, RandomStream& random, std::uint32_t crossings,
                           OnTheWay& onTheWay) {
    const MediaLeg leg{ray, ahead, crossings, random};
    const float tMax = leg.tMax();
    TrackedWeights weights{&path.beta, nullptr};
    if constexpr (kDispersion) weights.density = &path.densities.unidirectional;
    const MediumCollision collision = onTheWay(leg, [&](EmissionListener* emission) {
        return media.tracker.follow(ray, tMax, path.nested.here.media(), path.lambda, random, weights, emission,
                                    {path.pull.stretch()});
    });
    if (path.pull.pending) {
        const Spectrum m = path.pull.mixture(collision.medium ? collision.t : tMax, collision.medium != nullptr);
        if constexpr (kDispersion)
            path.densities.unidirectional *= m;
        else
            path.beta *= 1 / m[0];
    }
    if constexpr (kAbsorption)
        if (ahead) absorb(*ahead, ray.direction, collision.medium ? collision.t : tMax);
    if (!collision.medium) return false;
    if constexpr (kTextures) path.cone.advance(collision.t);
    ray.origin = placeOfCollision(ray, collision.t, ahead);
    collided = collision.medium;
    return true;
}

template <EffectBits E>
template <typename OnTheWay>
Arrival PathWalk<E>::arriveThrough(Ray& ray, SurfaceHit& hit, std::uint32_t depth,
                                   [[maybe_unused]] OnTheWay& onTheWay) {
    RandomStream random = sampler.stream(2 * depth);
    for (std::uint32_t crossings = 0; crossings < kMaxVertices; ++crossings) {
        const bool found = findAhead(ray, hit, random);
        if constexpr (kMedia) {
            if (collides(ray, found ? &hit : nullptr, random, crossings, onTheWay)) return Arrival::collision;
        } else if constexpr (kAbsorption) {
            if (found) absorb(hit, ray.direction, hit.distance);
        }
        if (!found) return Arrival::nowhere;
        if constexpr (kTextures) path.cone.advance(hit.distance);
        const float share = straightOn(hit, ray, path.nested);
        if (share < 1 && !(share > 0 && random.uniform() < share)) return Arrival::surface;
        ray.origin = spawnOrigin(hit, ray.direction);
        ++counters.effects.crossings;
        if (toldToLeave(crossings)) return Arrival::nowhere;
    }
    cap(&hit);
    path.beta = Spectrum(0.f);
    return Arrival::nowhere;
}

template <EffectBits E>
bool PathWalk<E>::sidesAgree(const SurfaceHit& hit, const EyeDirection& eye, Vec3 wi, Vec3 wiRender) {
    // A direction that is none agrees with nothing.
    const float geometrically = dot(eye.woRender, hit.ng) * dot(wiRender, hit.ng);
    return eye.wo.z * wi.z > 0 ? geometrically > 0 : geometrically <= 0;
}

template <EffectBits E>
inline bool PathWalk<E>::scatter(const SurfaceHit& hit, const BsdfSample& next, const EyeDirection& eye, Ray& ray) {
    estimate.checkWeight(next.weight);
    path.beta *= next.weight;
    path.bsdfPdf = next.pdfSolidAngle;
    path.delta = next.lobe.has(Lobe::delta);
    path.etaScale *= next.eta * next.eta;
    if constexpr (kDispersion) {
        auto& d = path.densities;
        if (path.delta && next.lobe.has(Lobe::dispersive)) {
            d.parted = true;
            endSecondaryWavelengths();
        }
        d.before = d.unidirectional;
        if (!path.delta) estimate.checkRatios(next.pdfRatio);
        if (!path.delta) d.unidirectional *= next.pdfRatio;
        if constexpr (kMedia) d.direction = d.unidirectional;
    }
    if constexpr (kMedia) {
        path.pull.n = hit.ng;
        path.pull.medium = nullptr;
    }
    const Vec3 direction = hit.shading.toWorld(next.wi);
    if (!sidesAgree(hit, eye, next.wi, direction)) return estimate.checkDirection(direction), false;
    if (next.lobe.has(Lobe::transmission)) {
        if constexpr (kInterfaces)
            path.nested.here = path.nested.beyond;
        else if constexpr (kAbsorption)
            path.interior.absorption = absorptionBeyond(hit, direction);
    }
    if constexpr (kTextures) {
        turnCone(hit, next, eye.wo.z);
        widenCone();
    }
    ray = {spawnOrigin(hit, direction), direction, kInfinity, path.time};
    return anyNonZero(path.beta);
}

// Mirrors and lenses widen or narrow the cone. `cosine`: that of the eye in the shading frame.
template <EffectBits E> void PathWalk<E>::turnCone(const SurfaceHit& hit, const BsdfSample& next, float cosine) {
    if (next.lobe.has(Lobe::diffuse)) return;
    // What stands in an instance has another scale: it counts as flat.
    const bool known = hit.shape && hit.instance == SurfaceHit::kNoInstance;
    const float bulge = known ? std::copysign(1.f, cosine) * hit.shape->meanCurvature(hit) : 0;
    if (next.lobe.has(Lobe::transmission))
        path.cone.refract(bulge, next.eta, std::abs(cosine));
    else
        path.cone.reflect(bulge, std::abs(cosine));
}

// The directions of a wide lobe lie far apart: each stands for a cone of about the solid angle 1/p. Only a part of that
// is averaged over, so that what a bounce sees keeps its texture (docs/language/textures.md, "Filtering").
template <EffectBits E> void PathWalk<E>::widenCone() {
    constexpr float kShare = 0.15f;
    if (path.delta) return;
    const float pdf = path.ownPdf > 0 ? path.ownPdf : path.bsdfPdf; // textures must not depend on the technique
    path.cone.spread = std::max(path.cone.spread, kShare / std::sqrt(kPi * pdf));
}

template <EffectBits E> Spectrum PathWalk<E>::clearness(const Surroundings& inside, float distance) const {
    if constexpr (kAbsorption)
        if (const Curve* clear = inside.absorption(); clear && distance < kInfinity)
            return exp(clear->at(path.lambda) * -distance);
    return Spectrum(1.f);
}

template <EffectBits E>
Spectrum PathWalk<E>::transmittance(Vec3 origin, const LightSample& light, const Surroundings& around,
                                    [[maybe_unused]] RandomStream random, RayKind kind, [[maybe_unused]] float least) {
    const bool infinite = !(light.distance < kInfinity);
    // Up to tMax; `end` is the same, measured as without media, where they shall make no difference.
    const auto along = [&](const Ray& ray, const Surroundings& inside, float tMax, float end) {
        const Spectrum clear = clearness(inside, end);
        if constexpr (kMedia)
            return clear * media.tracker.transmittance(ray, tMax, inside.media(), path.lambda, random, least);
        return clear;
    };
    Ray ray{origin, light.wi, infinite ? kInfinity : length(light.p - origin), path.time, kind};
    if (!context.scene.boundaries) {
        if (occluded(origin, light, kind)) return Spectrum(0.f);
        return along(ray, around, ray.tMax, light.distance);
    }
    Spectrum result(1.f);
    SurfaceHit hit;
    NestedDielectrics nested{around, {}};
    for (std::uint32_t crossings = 0; crossings < kMaxVertices; ++crossings) {
        // The direction is made anew: rounding would let long chains of boundaries miss the light's own point.
        if (!infinite) {
            const Vec3 way = light.p - ray.origin;
            ray.tMax = length(way);
            if (!(ray.tMax > 0)) return result;
            ray.direction = way / ray.tMax;
        }
        const bool found = context.scene.intersector->intersect(ray, hit) && hit.distance < ray.tMax;
        if (!found) return result * along(ray, nested.here, ray.tMax, crossings == 0 ? light.distance : ray.tMax);
        const Surroundings before = nested.here;
        const float share = straightOn(hit, ray, nested);
        if (share == 0) return Spectrum(0.f);
        result *= along(ray, before, hit.distance, hit.distance) * share;
        if (!anyNonZero(result)) return result;
        ray.origin = spawnOrigin(hit, ray.direction);
        ++counters.effects.shadowCrossings;
        if (toldToLeave(crossings)) return Spectrum(0.f);
    }
    cap(&hit);
    return Spectrum(0.f);
}

template <EffectBits E> float PathWalk<E>::throughput() const {
    // Tracking scales the densities: only their ratio to beta means anything. Beyond a bound beta may have a sign.
    if constexpr (kMedia && kDispersion)
        return mean(abs(path.beta)) / mean(path.densities.unidirectional) * path.etaScale;
    if constexpr (kMedia) return mean(abs(path.beta)) * path.etaScale;
    return mean(path.beta) * path.etaScale;
}

// The densities of all other lanes are 0, so that the mean of the ratios is 1/8 of the hero's and the hero counts
// eightfold. From here on every lane evaluates the hero's wavelength, which keeps means over lanes (lobe choices,
// roulette) meaningful; only lane 0 still adds to the image.
template <EffectBits E> void PathWalk<E>::endSecondaryWavelengths() {
    if (path.densities.heroOnly) return;
    path.densities.heroOnly = true;
    addWorkFlag(WorkFlag::heroOnly);
    if (!(path.densities.unidirectional[0] > 0)) { // a hero that the media on the way never chose
        path.beta = Spectrum(0.f);
        return;
    }
    const float hero = path.beta[0] * (static_cast<float>(kLanes) / path.densities.unidirectional[0]);
    path.beta = Spectrum(Float8{hero, 0, 0, 0, 0, 0, 0, 0});
    path.densities.unidirectional = Spectrum(1.f);
    path.lambda.keepHero();
}

// Beer–Lambert along `distance` of the segment towards `hit`. A camera inside a dielectric is known by its first hit: a
// boundary hit from behind while no interior was entered.
template <EffectBits E> void PathWalk<E>::absorb(const SurfaceHit& hit, Vec3 direction, float distance) {
    if constexpr (kInterfaces) {
        if (const Curve* clear = path.nested.here.absorption()) path.beta *= exp(clear->at(path.lambda) * -distance);
        return;
    }
    const Curve*& absorption = path.interior.absorption;
    if (!absorption && dot(direction, hit.ng) > 0) absorption = hit.material->absorption();
    if (absorption) path.beta *= exp(absorption->at(path.lambda) * -distance);
}

// Asked by loops that may be long, whose body has run so often.
template <EffectBits E> bool PathWalk<E>::toldToLeave(std::uint32_t count) {
    constexpr std::uint32_t kLongLoop = 64;
    if (count % kLongLoop != kLongLoop - 1) [[likely]]
        return false;
    return leavesIfTold();
}

// If the render is to end the path is left: what it has gathered is no number, which its gate (tile_kernel.h) does not
// let through.
template <EffectBits E> [[gnu::cold, gnu::noinline]] bool PathWalk<E>::leavesIfTold() {
    if (!context.toldToStop()) return false;
    counters.left = true;
    path.beta = Spectrum(0.f);
    estimate.leave();
    return true;
}

template <EffectBits E> [[gnu::cold, gnu::noinline]] void PathWalk<E>::cap(const SurfaceHit* hit) {
    ++counters.capped;
    counters.cappedIn = hit ? static_cast<const void*>(hit->shape) : collided;
}

} // namespace abbe
