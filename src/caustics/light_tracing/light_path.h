// Paths that start at the lights: every vertex at which light spreads is seen by the camera [Veach1997, ch. 10;
// Arvo1986].
#pragma once

#include "caustics/light_tracing/light_path_weights.h"
#include "caustics/shared/chain_signature.h"
#include "caustics/shared/kernel_jobs.h"
#include "light_sampling/light_target.h"
#include "transport/roulette.h"
#include "transport/walk.h"

namespace abbe {

// One path from a light through the scene, weighed against camera paths as light_path_weights.h states. It is walked as
// paths from the camera are, through the same media and boundaries; light that it brings to media that emit or to
// other lights is not its own.
template <EffectBits E> class LightPath {
    using Walk = PathWalk<E>;
    static_assert(Walk::kLightPaths);

  public:
    using Media = typename Walk::Media;

    // What it is given outlives it; the arenas are those of the path and of its vertices.
    LightPath(const PathContext& context, Sampler& sampler, Arena& arena, VertexArenas& vertexArenas,
              PathCounters& counters, Media& media)
        : walk_(context, sampler, arena, counters, media), arenas_(vertexArenas) {}

    // Whose start is set from outside.
    Walk& walk() { return walk_; }
    // Of all, those after the path was spread for the first time.
    std::uint64_t raysAfterSpread() const { return raysAfterSpread_ + (raysAtSpread_ ? rays() - *raysAtSpread_ : 0); }
    // Vertex 0 of the sampler has started the path; vertex k + 1 is that of the path's vertex k. All wavelengths go
    // through clear glass that disperses: each is a path of its own from there on.
    template <typename Tell> void trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell);
    // Of the hero alone behind such glass. Instead of what the lens sees: calls onSurface(hit, vertex, sample, depth)
    // and onCollision(place, direction, sample, depth) at every vertex before the path goes on from there; but for
    // collisions at the first. `mirroredFirst`: the path ends unless a mirror or clear glass is the first thing that it
    // hits.
    template <typename Surface, typename Collision>
    void follow(const EmittedRay&, const Wavelengths&, bool mirroredFirst, Surface onSurface, Collision onCollision);

    // While it is followed. At a vertex: density of camera paths that hit the light by scattering, without the
    // scattering there, over that of light paths.
    double cameraOdds() const;
    // A delta that it has gone by.
    struct Link {
        const Shape* shape = nullptr;
        Lobes lobe;
    };
    // All so far; nothing where it has hit anything else, or more than a chain may have.
    std::optional<std::span<const Link>> links() const {
        if (now_.linkCount > kMostLinks) return std::nullopt;
        return std::span(now_.links).first(now_.linkCount);
    }

  private:
    // Camera paths over light paths, up to the last vertex, as in light_path_weights.h the other way round.
    struct Rivals {
        double bsdf = 0;                               // those that hit the light by scattering
        double nee = 0;                                // by next-event estimation, from the second vertex on
        Spectrum ahead{1.f}, back{1.f}, neeAhead{1.f}; // densities over the hero's: of camera paths, light paths
        double of(double scattering, const Spectrum& ratio, bool hero) const {
            const auto over = [&](const Spectrum& camera) {
                return hero ? 1 : static_cast<double>(mean(camera * ratio)) / static_cast<double>(mean(back));
            };
            return scattering * (bsdf * over(ahead) + nee * over(neeAhead));
        }
    };

    static constexpr std::size_t kMostLinks = kLongestManifoldChain;
    // All that changes from vertex to vertex, beside the walk.
    struct Progress {
        Rivals rivals;
        bool first = true;                    // at the first vertex
        bool focused = false;                 // by the first vertex
        std::uint32_t spread = 0;             // how often so far
        std::array<Link, kMostLinks> links{}; // of the chain of deltas that the path has been so far,
        std::size_t linkCount = 0;            // kMostLinks + 1 where it is none or too long
    };
    // Where wavelengths part.
    struct Parting {
        std::uint32_t depth;
        SurfaceHit hit;
        VertexSample sample;
        bool raysCount; // as those of a path that was spread
        Progress before;
        PathState<E> path;
    };
    static constexpr std::uint32_t kLaneNumbers = 0x50000000; // beyond those of vertices

    template <typename Surface, typename Collision>
    void goOn(const EmittedRay&, Ray, std::uint32_t depth, bool mirroredFirst, Surface&, Collision&);
    template <typename Surface, typename Collision> void followOtherLanes(const EmittedRay&, Surface&, Collision&);
    void leadWith(int lane);
    void part(const SurfaceHit&, const VertexSample&, std::uint32_t depth);
    void keepLane();
    void arriveAt(const EmittedRay&, Vec3 p, double cosine);
    // Density with which next-event estimation of a camera path at the first vertex, coming from `away`, would draw
    // the place that the path started from, 1/sr.
    double neeDensity(const EmittedRay&, const SurfaceHit&, const LightVertex&, Vec3 away) const;
    double neeDensity(const EmittedRay&, const Receiver&, Vec3 direction, const ScatterView&) const;
    LightScattering weighed(const SurfaceHit&, Vec3 away, const LightVertexSample* sampled);
    template <typename Tell> void show(const SurfaceHit&, const LightVertex&, Vec2 lens, std::uint32_t depth, Tell&&);
    template <typename Tell> void showMedium(Vec3 p, Vec3 direction, Vec2 lens, std::uint32_t depth, Tell&&);
    template <typename Tell>
    void addSplat(const LensConnection&, const Spectrum& value, double rivals, bool spreads, Tell&&);
    PathComponent component(bool spreads) const {
        const std::uint32_t spread = now_.spread + spreads;
        if (now_.focused && spread > 0) return PathComponent::caustic;
        return spread <= 1 ? PathComponent::direct : PathComponent::indirect;
    }
    std::optional<LensConnection> connect(Vec3 p, Vec2 lens) const;
    Spectrum passing(Vec3 origin, const LensConnection&, bool through, std::uint32_t depth);
    bool hiddenFromCamera(const SurfaceHit&, Vec3 towardsLens) const;
    bool scatter(const EmittedRay&, const SurfaceHit&, const LightVertex&, const VertexSample&, std::uint32_t depth,
                 Ray&);
    bool scatterInMedium(const EmittedRay&, Ray&, const VertexSample&);
    bool survives(std::uint32_t depth);
    void endSpread() {
        raysAfterSpread_ = raysAfterSpread();
        raysAtSpread_.reset();
    }
    std::uint64_t rays() const { return walk_.counters.vertices + walk_.counters.shadowRays; }

    Walk walk_;
    VertexArenas& arenas_;
    Progress now_;
    bool all_ = false; // every wavelength goes through glass that disperses, and LightPathPlan::afterSpread counts
    // For how many lanes the one in hand stands. Roulette must not see it: its numbers are those of the hero's path, on
    // whose fate this depends.
    int standsFor_ = 1;
    int lane_ = 0; // of the film, that the hero's light belongs to
    std::optional<Parting> parting_;
    bool seen_ = false; // behind the parting
    std::optional<std::uint64_t> raysAtSpread_;
    std::uint64_t raysAfterSpread_ = 0;
    float startThroughput_ = 1;
};

template <EffectBits E>
template <typename Tell>
void LightPath<E>::trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell) {
    all_ = true;
    follow(
        start, lambda, false,
        [&](const SurfaceHit& hit, const LightVertex& vertex, const VertexSample& sample, std::uint32_t depth) {
            if (depth > 0) show(hit, vertex, sample.light, depth, tell); // camera paths have the first
        },
        [&](Vec3 p, Vec3 direction, const VertexSample& sample, std::uint32_t depth) {
            showMedium(p, direction, sample.light, depth, tell);
        });
}

template <EffectBits E>
template <typename Surface, typename Collision>
void LightPath<E>::follow(const EmittedRay& start, const Wavelengths& lambda, bool mirroredFirst, Surface onSurface,
                          Collision onCollision) {
    auto& path = walk_.path;
    walk_.start(lambda, start.ray.time);
    path.beta = start.beta;
    path.delta = false;
    startThroughput_ = std::max(mean(start.beta), std::numeric_limits<float>::min());
    goOn(start, start.ray, 0, mirroredFirst, onSurface, onCollision);
    if (parting_) followOtherLanes(start, onSurface, onCollision);
}

// With the ray that leaves vertex `depth` - 1.
template <EffectBits E>
template <typename Surface, typename Collision>
void LightPath<E>::goOn(const EmittedRay& start, Ray ray, std::uint32_t depth, bool mirroredFirst, Surface& onSurface,
                        Collision& onCollision) {
    auto& path = walk_.path;
    const std::uint32_t most = walk_.maxDepth();
    SurfaceHit hit;
    for (; depth < most; ++depth) {
        const Vec3 direction = ray.direction;
        const auto arrival = walk_.arrive(ray, hit, depth + 1);
        if (arrival == Arrival::nowhere || !anyNonZero(path.beta)) return;
        now_.first = depth == 0;
        const VertexSample sample = walk_.sampler.vertex(depth + 1);
        if (arrival == Arrival::collision) {
            if (now_.first) {
                if (mirroredFirst) return;
                arriveAt(start, ray.origin, 1);
            } else {
                onCollision(ray.origin, direction, sample, depth); // camera paths have the first
            }
            if (!scatterInMedium(start, ray, sample) || !survives(depth)) return;
            continue;
        }
        if (!hit.material->reversible()) return;
        // Along a surface no flux arrives, and what is stated per area has no density there.
        const auto cosine = static_cast<double>(std::abs(dot(direction, hit.ng)));
        if (!(cosine > 0)) return;
        arriveAt(start, hit.p, cosine);
        hit.arrival = direction;
        hit.footprint = 0;
        walk_.arena.reset();
        const LightVertex vertex(hit, path.lambda, walk_.arena, arenas_.eye);
        onSurface(hit, vertex, sample, depth);
        if (!scatter(start, hit, vertex, sample, depth, ray) || !survives(depth)) return;
        if (mirroredFirst && now_.first && now_.linkCount > kMostLinks) return;
    }
    walk_.endAtMaxDepth(&hit);
}

// What the other wavelengths do from the parting on. Where the hero's path was seen all of them are followed. Where it
// was not one is, and stands for all: most of them would be seen as little.
template <EffectBits E>
template <typename Surface, typename Collision>
void LightPath<E>::followOtherLanes(const EmittedRay& start, Surface& onSurface, Collision& onCollision) {
    const Parting from = *parting_;
    const bool heroSeen = seen_;
    standsFor_ = heroSeen ? 1 : kLanes - 1;
    RandomStream random = walk_.sampler.stream(kLaneNumbers);
    const int one = 1 + std::min(static_cast<int>(random.uniform() * (kLanes - 1)), kLanes - 2);
    for (int lane = 1; lane < kLanes; ++lane) {
        if (!heroSeen && lane != one) continue;
        if (!(from.before.rivals.back[lane] > 0)) continue; // no light path, had it been the hero: all of camera paths
        endSpread();
        now_ = from.before;
        walk_.path = from.path;
        if (from.raysCount) raysAtSpread_ = rays();
        leadWith(lane);
        arenas_.own.reset();
        walk_.arena.reset();
        const LightVertex vertex(from.hit, walk_.path.lambda, walk_.arena, arenas_.eye);
        Ray ray = start.ray;
        if (scatter(start, from.hit, vertex, from.sample, from.depth, ray) && walk_.path.densities.heroOnly &&
            survives(from.depth))
            goOn(start, ray, from.depth + 1, false, onSurface, onCollision);
    }
}

template <EffectBits E>
void LightPath<E>::part(const SurfaceHit& hit, const VertexSample& sample, std::uint32_t depth) {
    parting_.emplace(Parting{depth, hit, sample, raysAtSpread_.has_value(), now_, walk_.path});
    seen_ = false;
}

// The lane changes places with the hero, and all that is stated over the hero's becomes stated over its own.
template <EffectBits E> void LightPath<E>::leadWith(int lane) {
    auto& path = walk_.path;
    const auto swapped = [lane](Spectrum s) {
        const float hero = s.v[0];
        s.v[0] = s.v[lane];
        s.v[lane] = hero;
        return s;
    };
    const auto turned = [&](const Wavelengths& w) { return Wavelengths::at(swapped(w.nm), swapped(w.pdf)); };
    Rivals& r = now_.rivals;
    const double back = static_cast<double>(r.back[lane]);
    r.bsdf *= static_cast<double>(r.ahead[lane]) / back;
    r.nee *= static_cast<double>(r.neeAhead[lane]) / back;
    path.lambda = turned(path.lambda);
    path.densities.film = turned(path.densities.film);
    path.beta = swapped(path.beta);
    lane_ = lane;
}

// As PathWalk::endSecondaryWavelengths(), but that all lanes go on, each by itself: none counts for the others.
template <EffectBits E> void LightPath<E>::keepLane() {
    auto& path = walk_.path;
    path.beta = Spectrum(Float8{path.beta[0] / mean(path.densities.unidirectional), 0, 0, 0, 0, 0, 0, 0});
    path.densities.unidirectional = Spectrum(1.f);
    path.densities.heroOnly = true;
    path.lambda.keepHero();
    addWorkFlag(WorkFlag::heroOnly);
}

template <EffectBits E> void LightPath<E>::arriveAt(const EmittedRay& start, Vec3 p, double cosine) {
    if (now_.first) {
        double ends = 1;
        if (start.deltaPosition)
            ends = static_cast<double>(lengthSquared(p - start.ray.origin));
        else if (!start.density.distant)
            ends = static_cast<double>(std::abs(dot(start.n, start.ray.direction)));
        now_.rivals.nee = ends / start.density.total();
        now_.rivals.bsdf = start.neverHit ? 0 : now_.rivals.nee;
    }
    now_.rivals.bsdf /= cosine;
    now_.rivals.nee /= cosine;
}

template <EffectBits E> double LightPath<E>::cameraOdds() const {
    Rivals meeting = now_.rivals;
    meeting.nee = 0;
    return meeting.of(1, Spectrum(1.f), walk_.path.densities.heroOnly);
}

template <EffectBits E>
double LightPath<E>::neeDensity(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex,
                                Vec3 away) const {
    const auto view = vertex.seen(away);
    const Bsdf& bsdf = *view.bsdf;
    if (!bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return 0;
    const Vec3 wo = view.frame.toLocal(away), n = view.frame.z;
    const Receiver from{hit.p, wo.z < 0 ? -n : n, bsdf.lobes().has(Lobe::transmission)};
    ScatterView scatters;
    if (walk_.context.lights.usesLobes() && bsdf.lobes().has(Lobe::glossy)) scatters = {away, bsdf.outline(wo)};
    return neeDensity(start, from, -start.ray.direction, scatters);
}

// The same for what is at `from`, with the unit direction to the light.
template <EffectBits E>
double LightPath<E>::neeDensity(const EmittedRay& start, const Receiver& from, Vec3 direction,
                                const ScatterView& scatters) const {
    if (!walk_.context.how.nextEvent) return 0;
    const PathContext& context = walk_.context;
    const auto picked =
        static_cast<double>(context.lights.probability(start.light, start.part, from, scatters, context.arrival));
    if (start.deltaPosition || start.deltaDirection) return picked;
    const float time = walk_.path.time;
    const float pdf = start.density.distant
                          ? start.light->asDistant()->pdfEscaped(from, direction, time)
                          : start.light->asPlaced()->pdfAtPoint(from, start.part, start.ray.origin, start.n, time);
    return picked * static_cast<double>(pdf);
}

template <EffectBits E> std::optional<LensConnection> LightPath<E>::connect(Vec3 p, Vec2 lens) const {
    const Scene& scene = walk_.context.scene;
    LensQuery query = lensQuery(scene.frame, walk_.path.time, walk_.path.lambda.nm[0]);
    query.p = p;
    query.lens = lens;
    return scene.camera->connect(query);
}

// Of what lies between a vertex and the lens.
template <EffectBits E>
Spectrum LightPath<E>::passing(Vec3 origin, const LensConnection& c, bool through, std::uint32_t depth) {
    const LightSample end(c.wi, c.lens, c.distance, Spectrum(1.f), 1);
    ++walk_.counters.shadowRays;
    return walk_.transmittance(origin, end, walk_.path.nested.after(through), walk_.sampler.stream(2 * depth + 3),
                               RayKind::camera);
}

// Rays of light have hit what the camera may not see: then nothing that it sees lies there, to within rounding.
template <EffectBits E> bool LightPath<E>::hiddenFromCamera(const SurfaceHit& hit, Vec3 towardsLens) const {
    const float cosine = std::max(std::abs(dot(towardsLens, hit.ng)), 0.01f);
    const float near = (8 * dot(abs(hit.ng), hit.pError) + 0x1p-21f * hit.distance) / cosine;
    const Vec3 before = hit.p + towardsLens * near;
    return !walk_.context.scene.intersector->occluded(
        {before, -towardsLens, 2 * near, walk_.path.time, RayKind::camera});
}

// The densities at a vertex as both kinds of path tell them, of a path that belongs to its hero.
template <EffectBits E>
LightScattering LightPath<E>::weighed(const SurfaceHit& hit, Vec3 away, const LightVertexSample* sampled) {
    arenas_.own.reset();
    const LightVertex vertex(hit, walk_.path.densities.film, arenas_.own, arenas_.eye);
    return sampled && sampled->lobe.has(Lobe::delta) ? vertex.deltaTowards(away, sampled->eta) : vertex.towards(away);
}

template <EffectBits E>
template <typename Tell>
void LightPath<E>::show(const SurfaceHit& hit, const LightVertex& vertex, Vec2 lens, std::uint32_t depth, Tell&& tell) {
    if (!vertex.bsdf().lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // deltas hit no lens
    const auto c = connect(hit.p, lens);
    if (!c) return;
    const LightScattering s = vertex.towards(c->wi);
    if (!anyNonZero(s.fcos)) return;
    if (walk_.context.scene.hidden.fromCamera && hiddenFromCamera(hit, c->wi)) [[unlikely]]
        return;
    const bool through = dot(c->wi, hit.ng) * dot(hit.arrival, hit.ng) > 0;
    const Spectrum clear = passing(spawnOrigin(hit, c->wi), *c, through, depth);
    if (!anyNonZero(clear)) return;
    const LightScattering w = walk_.path.densities.heroOnly ? weighed(hit, c->wi, nullptr) : s;
    const bool hero = walk_.path.densities.heroOnly || c->heroOnly;
    const auto scattering = static_cast<double>(w.pdfReverse);
    const double rivals =
        now_.rivals.of(scattering, w.reverseRatio, hero) * static_cast<double>(std::abs(dot(c->wi, hit.ng)));
    addSplat(*c, walk_.path.beta * s.fcos * clear, rivals, vertex.bsdf().lobes().has(Lobe::diffuse), tell);
}

template <EffectBits E>
template <typename Tell>
void LightPath<E>::showMedium(Vec3 p, Vec3 direction, Vec2 lens, std::uint32_t depth, Tell&& tell) {
    if constexpr (Walk::kMedia) {
        const auto c = connect(p, lens);
        if (!c) return;
        const PhaseFunction& phase = walk_.collided->phase();
        const float cosine = dot(direction, c->wi), value = phase.value(cosine);
        if (value == 0) return;
        Spectrum clear = passing(p, *c, false, depth) * value;
        if (phase.spectral()) clear *= phase.ratio(cosine, walk_.path.lambda);
        if (!anyNonZero(clear)) return;
        const bool hero = walk_.path.densities.heroOnly || c->heroOnly;
        addSplat(*c, walk_.path.beta * clear, now_.rivals.of(static_cast<double>(value), Spectrum(1.f), hero), true,
                 tell);
    }
}

// The balance of the wavelengths: means over all that could have been the hero [Wilkie2014].
template <EffectBits E>
template <typename Tell>
void LightPath<E>::addSplat(const LensConnection& c, const Spectrum& value, double rivals, bool spreads, Tell&& tell) {
    const LightPathPlan& plan = *walk_.context.lightPaths;
    const int lanes = walk_.path.densities.heroOnly ? kLanes : 1; // each a path of its own
    rivals *= plan.alone ? 0 : static_cast<double>(c.pdfFacingArea) / (lanes * static_cast<double>(plan.paths));
    Spectrum seen = value * (c.importance * static_cast<float>(1 / (1 + rivals)));
    const Spectrum& densities = walk_.path.densities.unidirectional;
    if (c.heroOnly && !walk_.path.densities.heroOnly)
        seen = Spectrum(Float8{seen[0] * static_cast<float>(kLanes) / densities[0], 0, 0, 0, 0, 0, 0, 0});
    else
        seen *= 1 / mean(densities);
    if (lane_ > 0) {
        Float8 moved{};
        moved[lane_] = seen[0];
        seen = Spectrum(moved);
    }
    seen_ = true;
    tell(LensSplat{c.film, seen * static_cast<float>(standsFor_), rivals, component(spreads), now_.spread > 0});
}

template <EffectBits E>
bool LightPath<E>::scatter(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex,
                           const VertexSample& sample, std::uint32_t depth, Ray& ray) {
    auto& path = walk_.path;
    const auto next = vertex.sample(sample.lobe, sample.bsdf);
    const bool parts = all_ && !path.densities.heroOnly &&
                       (next ? next->lobe.has(Lobe::delta) && next->lobe.has(Lobe::dispersive)
                             : vertex.bsdf().lobes().has(Lobe::delta) && vertex.bsdf().lobes().has(Lobe::dispersive));
    if (parts && !parting_) part(hit, sample, depth);
    if (!next) return false;
    const LightScattering& s = next->scattering;
    const bool delta = next->lobe.has(Lobe::delta);
    const LightScattering w = path.densities.heroOnly ? weighed(hit, next->away, &*next) : s;
    path.beta *= s.fcos * (1 / s.pdfSolidAngle);
    if (parts)
        keepLane();
    else if (delta && next->lobe.has(Lobe::dispersive))
        walk_.endSecondaryWavelengths();
    if (!delta) path.densities.unidirectional *= Spectrum(s.pdfRatio);
    if (!(w.pdfSolidAngle > 0)) return false;
    const double on = static_cast<double>(std::abs(dot(next->away, hit.ng))) / static_cast<double>(w.pdfSolidAngle);
    const double camera = on * static_cast<double>(w.pdfReverse);
    if (!delta) {
        now_.rivals.ahead *= Spectrum(w.reverseRatio);
        if (!now_.first) now_.rivals.neeAhead *= Spectrum(w.reverseRatio);
        now_.rivals.back *= Spectrum(w.pdfRatio);
    }
    now_.rivals.bsdf *= camera;
    if (!now_.first)
        now_.rivals.nee *= camera;
    else // deltas have no next-event estimation
        now_.rivals.nee *= delta ? 0 : on * neeDensity(start, hit, vertex, next->away);
    now_.focused = now_.first ? !next->lobe.has(Lobe::diffuse) : now_.focused;
    if (delta && now_.linkCount < kMostLinks)
        now_.links[now_.linkCount++] = {hit.shape, next->lobe};
    else
        now_.linkCount = kMostLinks + 1;
    now_.spread += next->lobe.has(Lobe::diffuse);
    if (next->lobe.has(Lobe::transmission)) path.nested.here = path.nested.beyond;
    ray = {spawnOrigin(hit, next->away), next->away, kInfinity, path.time};
    return anyNonZero(path.beta);
}

template <EffectBits E>
bool LightPath<E>::scatterInMedium(const EmittedRay& start, Ray& ray, const VertexSample& sample) {
    const PhaseFunction& phase = walk_.collided->phase();
    const float cosine = phase.sampleCosine(sample.bsdf.x);
    if (now_.first) {
        const auto density = static_cast<double>(phase.value(cosine));
        if (!(density > 0)) return false;
        const double nee = walk_.isLit(*walk_.collided) ? neeDensity(start, ray.origin, -start.ray.direction, {}) : 0;
        now_.rivals.nee *= nee / density;
    }
    if (phase.spectral()) walk_.path.beta *= phase.ratio(cosine, walk_.path.lambda);
    ray.direction = directionAbout(ray.direction, cosine, sample.bsdf.y);
    ++now_.spread;
    now_.linkCount = kMostLinks + 1;
    return anyNonZero(walk_.path.beta);
}

template <EffectBits E> bool LightPath<E>::survives(std::uint32_t depth) {
    float p = 1;
    if (depth >= 3) {
        float throughput = mean(abs(walk_.path.beta)) / startThroughput_;
        if constexpr (Walk::kMedia) throughput /= mean(walk_.path.densities.unidirectional);
        if (all_ && walk_.path.densities.heroOnly) throughput *= static_cast<float>(kLanes); // of its own lane
        p = std::min(depth >= kLongPath ? walk_.longSurvival(depth) : 1.f,
                     std::clamp(throughput, RouletteReference::kFloor, 1.f));
    }
    if (now_.spread > 0 && !raysAtSpread_) {
        raysAtSpread_ = rays();
        if (all_) p *= walk_.context.lightPaths->afterSpread;
    }
    return walk_.survives(depth, p);
}

} // namespace abbe
