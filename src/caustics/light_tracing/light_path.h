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
    std::uint64_t raysAfterSpread() const { return raysAtSpread_ ? rays() - *raysAtSpread_ : 0; }
    // Vertex 0 of the sampler has started the path; vertex k + 1 is that of the path's vertex k.
    template <typename Tell> void trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell);
    // Instead of what the lens sees: calls onSurface(hit, vertex, sample, depth) and onCollision(place, direction,
    // sample, depth) at every vertex before the path goes on from there; but for collisions at the first.
    // `mirroredFirst`: the path ends unless a mirror or clear glass is the first thing that it hits.
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
        if (linkCount_ > kMostLinks) return std::nullopt;
        return std::span(links_).first(linkCount_);
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

    void arriveAt(const EmittedRay&, Vec3 p, double cosine);
    // Density with which next-event estimation of a camera path at the first vertex, coming from `away`, would draw
    // the place that the path started from, 1/sr.
    double neeDensity(const EmittedRay&, const SurfaceHit&, const LightVertex&, Vec3 away) const;
    double neeDensity(const EmittedRay&, const Receiver&, Vec3 direction, const ScatterView&) const;
    LightScattering weighed(const SurfaceHit&, Vec3 away, const LightVertexSample* sampled);
    template <typename Tell>
    void show(const EmittedRay&, const SurfaceHit&, const LightVertex&, Vec2 lens, std::uint32_t depth, Tell&&);
    template <typename Tell> void showMedium(Vec3 p, Vec3 direction, Vec2 lens, std::uint32_t depth, Tell&&);
    template <typename Tell>
    void addSplat(const LensConnection&, const Spectrum& value, double rivals, bool spreads, Tell&&);
    PathComponent component(bool spreads) const {
        const std::uint32_t spread = spread_ + spreads;
        if (focused_ && spread > 0) return PathComponent::caustic;
        return spread <= 1 ? PathComponent::direct : PathComponent::indirect;
    }
    std::optional<LensConnection> connect(Vec3 p, Vec2 lens) const;
    Spectrum passing(Vec3 origin, const LensConnection&, bool through, std::uint32_t depth);
    bool hiddenFromCamera(const SurfaceHit&, Vec3 towardsLens) const;
    bool scatter(const EmittedRay&, const SurfaceHit&, const LightVertex&, const VertexSample&, Ray&);
    bool scatterInMedium(const EmittedRay&, Ray&, const VertexSample&);
    bool survives(std::uint32_t depth);
    std::uint64_t rays() const { return walk_.counters.vertices + walk_.counters.shadowRays; }

    Walk walk_;
    VertexArenas& arenas_;
    Rivals rivals_;
    bool first_ = true;        // at the first vertex
    bool focused_ = false;     // by the first vertex
    std::uint32_t spread_ = 0; // how often so far
    bool fewerSpread_ = false; // LightPathPlan::afterSpread
    static constexpr std::size_t kMostLinks = kLongestManifoldChain;
    std::array<Link, kMostLinks> links_{}; // of the chain of deltas that the path has been so far,
    std::size_t linkCount_ = 0;            // kMostLinks + 1 where it is none or too long
    std::optional<std::uint64_t> raysAtSpread_;
    float startThroughput_ = 1;
};

template <EffectBits E>
template <typename Tell>
void LightPath<E>::trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell) {
    fewerSpread_ = true;
    follow(
        start, lambda, false,
        [&](const SurfaceHit& hit, const LightVertex& vertex, const VertexSample& sample, std::uint32_t depth) {
            show(start, hit, vertex, sample.light, depth, tell);
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
    const std::uint32_t most = walk_.maxDepth();
    Ray ray = start.ray;
    SurfaceHit hit;
    for (std::uint32_t depth = 0; depth < most; ++depth) {
        const Vec3 direction = ray.direction;
        const auto arrival = walk_.arrive(ray, hit, depth + 1);
        if (arrival == Arrival::nowhere || !anyNonZero(path.beta)) return;
        first_ = depth == 0;
        const VertexSample sample = walk_.sampler.vertex(depth + 1);
        if (arrival == Arrival::collision) {
            if (first_) {
                if (mirroredFirst) return;
                arriveAt(start, ray.origin, 1);
            } else {
                onCollision(ray.origin, direction, sample, depth); // camera paths have the first, if it is seen at once
            }
            if (!scatterInMedium(start, ray, sample) || !survives(depth)) return;
            continue;
        }
        if (!hit.material->reversible()) return;
        arriveAt(start, hit.p, static_cast<double>(std::abs(dot(direction, hit.ng))));
        hit.arrival = direction;
        hit.footprint = 0;
        walk_.arena.reset();
        const LightVertex vertex(hit, path.lambda, walk_.arena, arenas_.eye);
        onSurface(hit, vertex, sample, depth);
        if (!scatter(start, hit, vertex, sample, ray) || !survives(depth)) return;
        if (mirroredFirst && first_ && linkCount_ > kMostLinks) return;
    }
    walk_.endAtMaxDepth(&hit);
}

template <EffectBits E> void LightPath<E>::arriveAt(const EmittedRay& start, Vec3 p, double cosine) {
    if (first_) {
        double ends = 1;
        if (start.deltaPosition)
            ends = static_cast<double>(lengthSquared(p - start.ray.origin));
        else if (!start.density.distant)
            ends = static_cast<double>(std::abs(dot(start.n, start.ray.direction)));
        rivals_.nee = ends / start.density.total();
        rivals_.bsdf = start.neverHit ? 0 : rivals_.nee;
    }
    rivals_.bsdf /= cosine;
    rivals_.nee /= cosine;
}

template <EffectBits E> double LightPath<E>::cameraOdds() const {
    Rivals meeting = rivals_;
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
    const auto picked = static_cast<double>(walk_.context.lights.probability(start.light, start.part, from, scatters));
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
    return walk_.transmittance(origin, end, {walk_.path.nested.after(through), {}}, walk_.sampler.stream(2 * depth + 3),
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
void LightPath<E>::show(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex, Vec2 lens,
                        std::uint32_t depth, Tell&& tell) {
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
    Rivals rivals = rivals_;
    if (first_) rivals.nee = 0;
    double density = rivals.of(scattering, w.reverseRatio, hero);
    if (first_) density += rivals_.nee * neeDensity(start, hit, vertex, c->wi);
    density *= static_cast<double>(std::abs(dot(c->wi, hit.ng)));
    addSplat(*c, walk_.path.beta * s.fcos * clear, density, vertex.bsdf().lobes().has(Lobe::diffuse), tell);
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
        addSplat(*c, walk_.path.beta * clear, rivals_.of(static_cast<double>(value), Spectrum(1.f), hero), true, tell);
    }
}

// The balance of the wavelengths: means over all that could have been the hero [Wilkie2014].
template <EffectBits E>
template <typename Tell>
void LightPath<E>::addSplat(const LensConnection& c, const Spectrum& value, double rivals, bool spreads, Tell&& tell) {
    const LightPathPlan& plan = *walk_.context.lightPaths;
    rivals *= plan.alone ? 0 : static_cast<double>(c.pdfFacingArea) / plan.paths;
    Spectrum seen = value * (c.importance * static_cast<float>(1 / (1 + rivals)));
    const Spectrum& densities = walk_.path.densities.unidirectional;
    if (c.heroOnly && !walk_.path.densities.heroOnly)
        seen = Spectrum(Float8{seen[0] * static_cast<float>(kLanes) / densities[0], 0, 0, 0, 0, 0, 0, 0});
    else
        seen *= 1 / mean(densities);
    tell(LensSplat{c.film, seen, rivals, component(spreads), spread_ > 0});
}

template <EffectBits E>
bool LightPath<E>::scatter(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex,
                           const VertexSample& sample, Ray& ray) {
    auto& path = walk_.path;
    const auto next = vertex.sample(sample.lobe, sample.bsdf);
    if (!next) return false;
    const LightScattering& s = next->scattering;
    const bool delta = next->lobe.has(Lobe::delta);
    const LightScattering w = path.densities.heroOnly ? weighed(hit, next->away, &*next) : s;
    path.beta *= s.fcos * (1 / s.pdfSolidAngle);
    if (delta && next->lobe.has(Lobe::dispersive)) walk_.endSecondaryWavelengths();
    if (!delta) path.densities.unidirectional *= Spectrum(s.pdfRatio);
    if (!(w.pdfSolidAngle > 0)) return false;
    const double on = static_cast<double>(std::abs(dot(next->away, hit.ng))) / static_cast<double>(w.pdfSolidAngle);
    const double camera = on * static_cast<double>(w.pdfReverse);
    if (!delta) {
        rivals_.ahead *= Spectrum(w.reverseRatio);
        if (!first_) rivals_.neeAhead *= Spectrum(w.reverseRatio);
        rivals_.back *= Spectrum(w.pdfRatio);
    }
    rivals_.bsdf *= camera;
    if (!first_)
        rivals_.nee *= camera;
    else // deltas have no next-event estimation
        rivals_.nee *= delta ? 0 : on * neeDensity(start, hit, vertex, next->away);
    focused_ = first_ ? !next->lobe.has(Lobe::diffuse) : focused_;
    if (delta && linkCount_ < kMostLinks)
        links_[linkCount_++] = {hit.shape, next->lobe};
    else
        linkCount_ = kMostLinks + 1;
    spread_ += next->lobe.has(Lobe::diffuse);
    if (next->lobe.has(Lobe::transmission)) path.nested.here = path.nested.beyond;
    ray = {spawnOrigin(hit, next->away), next->away, kInfinity, path.time};
    return anyNonZero(path.beta);
}

template <EffectBits E>
bool LightPath<E>::scatterInMedium(const EmittedRay& start, Ray& ray, const VertexSample& sample) {
    const PhaseFunction& phase = walk_.collided->phase();
    const float cosine = phase.sampleCosine(sample.bsdf.x);
    if (first_) {
        const auto density = static_cast<double>(phase.value(cosine));
        if (!(density > 0)) return false;
        rivals_.nee *= neeDensity(start, ray.origin, -start.ray.direction, {}) / density;
    }
    if (phase.spectral()) walk_.path.beta *= phase.ratio(cosine, walk_.path.lambda);
    ray.direction = directionAbout(ray.direction, cosine, sample.bsdf.y);
    ++spread_;
    linkCount_ = kMostLinks + 1;
    return anyNonZero(walk_.path.beta);
}

template <EffectBits E> bool LightPath<E>::survives(std::uint32_t depth) {
    float p = 1;
    if (depth >= 3) {
        float throughput = mean(abs(walk_.path.beta)) / startThroughput_;
        if constexpr (Walk::kMedia) throughput /= mean(walk_.path.densities.unidirectional);
        p = std::min(depth >= kLongPath ? walk_.longSurvival(depth) : 1.f,
                     std::clamp(throughput, RouletteReference::kFloor, 1.f));
    }
    if (spread_ > 0 && !raysAtSpread_) {
        raysAtSpread_ = rays();
        if (fewerSpread_) p *= walk_.context.lightPaths->afterSpread;
    }
    return walk_.survives(depth, p);
}

} // namespace abbe
