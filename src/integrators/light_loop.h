// Paths that start at the lights: every vertex at which light spreads is seen by the camera [Veach1997, ch. 10;
// Arvo1986].
#pragma once

#include "caustics/merging/photon_map.h"
#include "integrators/path_loop.h"
#include "light_sampling/emitted_ray.h"
#include "render/path_component.h"

namespace abbe {

// What a vertex of a light path adds to the picture.
struct LensSplat {
    Vec2 film;         // as CameraSample::film
    Spectrum value;    // pixels · radiance at the wavelengths that the path started with: its mean over all light
                       // paths, per unit of the filter's integral, is what light paths bring to the picture
    double rivals = 0; // how many times as likely camera paths find the same; `value` is weighed by 1 / (1 + rivals)
    PathComponent component = PathComponent::direct;
    bool spread = false; // before this vertex, by a matte lobe or in a medium
};

// One path from a light through the scene, weighed against camera paths as path_loop_traced.h states. It is walked as
// paths from the camera are, through the same media and boundaries; light that it brings to media that shine or to
// other lights is not its own.
template <EffectBits E> class LightLoop : private PathLoop<E> {
    using Base = PathLoop<E>;
    static_assert(Base::kTraced);

  public:
    using Media = typename Base::Media;
    using Base::makeMedia;

    // Three arenas: of the path, of the view, which LightVertex asks for.
    LightLoop(const PathContext& context, Sampler& sampler, Arena& arena, TracedView& view, PathCounters& counters,
              Media& media)
        : Base(context, sampler, arena, counters, media), view_(view) {}

    void startIn(const Surroundings& around) { this->path_.nested.here = around; }
    // Of all, those after the path was spread for the first time.
    std::uint64_t raysAfterSpread() const { return raysAtSpread_ ? rays() - *raysAtSpread_ : 0; }
    // Vertex 0 of the sampler has started the path; vertex k + 1 is that of the path's vertex k.
    template <typename Tell> void trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell);
    // Instead of what the lens sees: tells of the photons that the path leaves for merging.
    template <typename Tell> void leavePhotons(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell);

  private:
    // Camera paths over light paths, up to the last vertex, as in path_loop_traced.h the other way round.
    struct Rivals {
        double met = 0;                                  // those that meet the light by scattering
        double asked = 0;                                // those that ask the light for it, from the second vertex on
        Spectrum ahead{1.f}, back{1.f}, askedAhead{1.f}; // densities over the hero's: of camera paths, light paths
        double of(double scattering, const Spectrum& ratio, bool hero) const {
            const auto over = [&](const Spectrum& camera) {
                return hero ? 1 : static_cast<double>(mean(camera * ratio)) / static_cast<double>(mean(back));
            };
            return scattering * (met * over(ahead) + asked * over(askedAhead));
        }
    };

    // Calls onSurface(hit, vertex, sample, depth) and onCollision(place, direction, sample, depth), and goes on.
    template <typename Surface, typename Collision>
    void walk(const EmittedRay&, const Wavelengths&, Surface onSurface, Collision onCollision);
    void arriveAt(const EmittedRay&, Vec3 p, double cosine);
    Photon photonOf(const EmittedRay&, Vec3 p, Vec3 direction, std::uint32_t depth) const;
    bool followedFrom(const EmittedRay&, const SurfaceHit&) const;
    // Density with which a camera path at the first vertex, coming from `away`, asks for the place that the path
    // started from, 1/sr.
    double askedDensity(const EmittedRay&, const SurfaceHit&, const LightVertex&, Vec3 away) const;
    double askedDensity(const EmittedRay&, const Receiver&, Vec3 direction, const ScatterView&) const;
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
    std::uint64_t rays() const { return this->counters_.vertices + this->counters_.shadowRays; }

    TracedView& view_;
    Rivals rivals_;
    bool first_ = true;                            // at the first vertex
    bool focused_ = false;                         // by the first vertex
    std::uint32_t spread_ = 0;                     // how often so far
    bool mirroredFirst_ = false, photons_ = false; // by the first vertex; whether that is all that counts
    struct Link {
        const Shape* shape = nullptr;
        Lobes lobe;
    };
    static constexpr std::size_t kMostLinks = ChainSignature::kMaxLength;
    std::array<Link, kMostLinks> links_{}; // of the chain of deltas that the path has been so far,
    std::size_t linkCount_ = 0;            // kMostLinks + 1 where it is none or too long
    std::optional<std::uint64_t> raysAtSpread_;
    float startThroughput_ = 1;
};

template <EffectBits E>
template <typename Tell>
void LightLoop<E>::trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell) {
    walk(
        start, lambda,
        [&](const SurfaceHit& hit, const LightVertex& vertex, const VertexSample& sample, std::uint32_t depth) {
            show(start, hit, vertex, sample.light, depth, tell);
        },
        [&](Vec3 p, Vec3 direction, const VertexSample& sample, std::uint32_t depth) {
            showMedium(p, direction, sample.light, depth, tell);
        });
}

template <EffectBits E>
template <typename Surface, typename Collision>
void LightLoop<E>::walk(const EmittedRay& start, const Wavelengths& lambda, Surface onSurface, Collision onCollision) {
    auto& path = this->path_;
    path.lambda = lambda;
    path.time = start.ray.time;
    path.beta = start.beta;
    path.delta = false;
    startThroughput_ = std::max(mean(start.beta), std::numeric_limits<float>::min());
    path.densities.film = lambda;
    const auto& settings = this->context_.settings;
    const std::uint32_t most = settings.maxDepth ? settings.maxDepth : Base::kMaxVertices;
    Ray ray = start.ray;
    SurfaceHit hit;
    for (std::uint32_t depth = 0; depth < most; ++depth) {
        this->countRay();
        const Vec3 direction = ray.direction;
        const auto arrival = this->arrive(ray, hit, depth + 1);
        if (arrival == Base::Arrival::nowhere || !anyNonZero(path.beta)) return;
        first_ = depth == 0;
        const VertexSample sample = this->sampler_.vertex(depth + 1);
        if (arrival == Base::Arrival::collision) {
            if (first_) {
                if (photons_) return; // light that no mirror has sent is not merged
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
        this->arena_.reset();
        const LightVertex vertex(hit, path.lambda, this->arena_, view_.eye);
        onSurface(hit, vertex, sample, depth);
        if (!scatter(start, hit, vertex, sample, ray) || !survives(depth)) return;
        if (photons_ && !mirroredFirst_) return;
    }
    if (settings.maxDepth == 0) this->cap(&hit);
}

template <EffectBits E> void LightLoop<E>::arriveAt(const EmittedRay& start, Vec3 p, double cosine) {
    if (first_) {
        double ends = 1;
        if (start.deltaPosition)
            ends = static_cast<double>(lengthSquared(p - start.ray.origin));
        else if (!start.density.distant)
            ends = static_cast<double>(std::abs(dot(start.n, start.ray.direction)));
        rivals_.asked = ends / start.density.total();
        rivals_.met = start.unmet ? 0 : rivals_.asked;
    }
    rivals_.met /= cosine;
    rivals_.asked /= cosine;
}

template <EffectBits E>
double LightLoop<E>::askedDensity(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex,
                                  Vec3 away) const {
    const auto view = vertex.seen(away);
    const Bsdf& bsdf = *view.bsdf;
    if (!bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return 0;
    const Vec3 wo = view.frame.toLocal(away), n = view.frame.z;
    const Receiver from{hit.p, wo.z < 0 ? -n : n, bsdf.lobes().has(Lobe::transmission)};
    ScatterView scatters;
    if (this->context_.lights.asksForLobes() && bsdf.lobes().has(Lobe::glossy)) scatters = {away, bsdf.outline(wo)};
    return askedDensity(start, from, -start.ray.direction, scatters);
}

// The same for what is at `from`, with the unit direction to the light.
template <EffectBits E>
double LightLoop<E>::askedDensity(const EmittedRay& start, const Receiver& from, Vec3 direction,
                                  const ScatterView& scatters) const {
    if (!this->context_.how.asksLights) return 0;
    const auto picked = static_cast<double>(this->context_.lights.probability(start.light, start.part, from, scatters));
    if (start.deltaPosition || start.deltaDirection) return picked;
    const float time = this->path_.time;
    const float pdf = start.density.distant
                          ? start.light->asDistant()->pdfEscaped(from, direction, time)
                          : start.light->asPlaced()->pdfAtPoint(from, start.part, start.ray.origin, start.n, time);
    return picked * static_cast<double>(pdf);
}

template <EffectBits E> std::optional<LensConnection> LightLoop<E>::connect(Vec3 p, Vec2 lens) const {
    const Scene& scene = this->context_.scene;
    LensQuery query = lensQuery(scene.frame, this->path_.time, this->path_.lambda.nm[0]);
    query.p = p;
    query.lens = lens;
    return scene.camera->connect(query);
}

// Of what lies between a vertex and the lens.
template <EffectBits E>
Spectrum LightLoop<E>::passing(Vec3 origin, const LensConnection& c, bool through, std::uint32_t depth) {
    const LightSample end(c.wi, c.lens, c.distance, Spectrum(1.f), 1);
    ++this->counters_.shadowRays;
    return this->transmittance(origin, end, {this->path_.nested.after(through), {}},
                               this->sampler_.stream(2 * depth + 3), RayKind::camera);
}

// Rays of light have met what the camera may not see: then nothing that it sees lies there, to within rounding.
template <EffectBits E> bool LightLoop<E>::hiddenFromCamera(const SurfaceHit& hit, Vec3 towardsLens) const {
    const float cosine = std::max(std::abs(dot(towardsLens, hit.ng)), 0.01f);
    const float near = (8 * dot(abs(hit.ng), hit.pError) + 0x1p-21f * hit.distance) / cosine;
    const Vec3 before = hit.p + towardsLens * near;
    return !this->context_.scene.intersector->occluded(
        {before, -towardsLens, 2 * near, this->path_.time, RayKind::camera});
}

// The densities at a vertex as both kinds of path tell them, of a path that belongs to its hero.
template <EffectBits E>
LightScattering LightLoop<E>::weighed(const SurfaceHit& hit, Vec3 away, const LightVertexSample* sampled) {
    view_.own.reset();
    const LightVertex vertex(hit, this->path_.densities.film, view_.own, view_.eye);
    return sampled && sampled->lobe.has(Lobe::delta) ? vertex.deltaTowards(away, sampled->eta) : vertex.towards(away);
}

template <EffectBits E>
template <typename Tell>
void LightLoop<E>::show(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex, Vec2 lens,
                        std::uint32_t depth, Tell&& tell) {
    if (!vertex.bsdf().lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // deltas meet no lens
    const auto c = connect(hit.p, lens);
    if (!c) return;
    const LightScattering s = vertex.towards(c->wi);
    if (!anyNonZero(s.fcos)) return;
    if (this->context_.scene.hidden.fromCamera && hiddenFromCamera(hit, c->wi)) [[unlikely]]
        return;
    const bool through = dot(c->wi, hit.ng) * dot(hit.arrival, hit.ng) > 0;
    const Spectrum clear = passing(spawnOrigin(hit, c->wi), *c, through, depth);
    if (!anyNonZero(clear)) return;
    const LightScattering w = this->path_.densities.heroOnly ? weighed(hit, c->wi, nullptr) : s;
    const bool hero = this->path_.densities.heroOnly || c->heroOnly;
    const auto scattering = static_cast<double>(w.pdfReverse);
    Rivals rivals = rivals_;
    if (first_) rivals.asked = 0;
    double density = rivals.of(scattering, w.reverseRatio, hero);
    if (first_) density += rivals_.asked * askedDensity(start, hit, vertex, c->wi);
    density *= static_cast<double>(std::abs(dot(c->wi, hit.ng)));
    addSplat(*c, this->path_.beta * s.fcos * clear, density, vertex.bsdf().lobes().has(Lobe::diffuse), tell);
}

template <EffectBits E>
template <typename Tell>
void LightLoop<E>::showMedium(Vec3 p, Vec3 direction, Vec2 lens, std::uint32_t depth, Tell&& tell) {
    if constexpr (Base::kMedia) {
        const auto c = connect(p, lens);
        if (!c) return;
        const PhaseFunction& phase = this->collided_->phase();
        const float cosine = dot(direction, c->wi), value = phase.value(cosine);
        if (value == 0) return;
        Spectrum clear = passing(p, *c, false, depth) * value;
        if (phase.spectral()) clear *= phase.ratio(cosine, this->path_.lambda);
        if (!anyNonZero(clear)) return;
        const bool hero = this->path_.densities.heroOnly || c->heroOnly;
        addSplat(*c, this->path_.beta * clear, rivals_.of(static_cast<double>(value), Spectrum(1.f), hero), true, tell);
    }
}

// The balance of the wavelengths: means over all that could have been the hero [Wilkie2014].
template <EffectBits E>
template <typename Tell>
void LightLoop<E>::addSplat(const LensConnection& c, const Spectrum& value, double rivals, bool spreads, Tell&& tell) {
    const LightPathPlan& plan = *this->context_.traced;
    rivals *= plan.alone ? 0 : static_cast<double>(c.pdfFacingArea) / plan.paths;
    Spectrum seen = value * (c.importance * static_cast<float>(1 / (1 + rivals)));
    const Spectrum& densities = this->path_.densities.unidirectional;
    if (c.heroOnly && !this->path_.densities.heroOnly)
        seen = Spectrum(Float8{seen[0] * static_cast<float>(kLanes) / densities[0], 0, 0, 0, 0, 0, 0, 0});
    else
        seen *= 1 / mean(densities);
    tell(LensSplat{c.film, seen, rivals, component(spreads), spread_ > 0});
}

template <EffectBits E>
bool LightLoop<E>::scatter(const EmittedRay& start, const SurfaceHit& hit, const LightVertex& vertex,
                           const VertexSample& sample, Ray& ray) {
    auto& path = this->path_;
    const auto next = vertex.sample(sample.lobe, sample.bsdf);
    if (!next) return false;
    const LightScattering& s = next->scattering;
    const bool delta = next->lobe.has(Lobe::delta);
    const LightScattering w = path.densities.heroOnly ? weighed(hit, next->away, &*next) : s;
    path.beta *= s.fcos * (1 / s.pdfSolidAngle);
    if (delta && next->lobe.has(Lobe::dispersive)) this->endSecondaryWavelengths();
    if (!delta) path.densities.unidirectional *= Spectrum(s.pdfRatio);
    if (!(w.pdfSolidAngle > 0)) return false;
    const double on = static_cast<double>(std::abs(dot(next->away, hit.ng))) / static_cast<double>(w.pdfSolidAngle);
    const double camera = on * static_cast<double>(w.pdfReverse);
    if (!delta) {
        rivals_.ahead *= Spectrum(w.reverseRatio);
        if (!first_) rivals_.askedAhead *= Spectrum(w.reverseRatio);
        rivals_.back *= Spectrum(w.pdfRatio);
    }
    rivals_.met *= camera;
    if (!first_)
        rivals_.asked *= camera;
    else // deltas cannot be asked
        rivals_.asked *= delta ? 0 : on * askedDensity(start, hit, vertex, next->away);
    focused_ = first_ ? !next->lobe.has(Lobe::diffuse) : focused_;
    mirroredFirst_ = first_ ? delta : mirroredFirst_;
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
bool LightLoop<E>::scatterInMedium(const EmittedRay& start, Ray& ray, const VertexSample& sample) {
    const PhaseFunction& phase = this->collided_->phase();
    const float cosine = phase.sampleCosine(sample.bsdf.x);
    if (first_) {
        const auto density = static_cast<double>(phase.value(cosine));
        if (!(density > 0)) return false;
        rivals_.asked *= askedDensity(start, ray.origin, -start.ray.direction, {}) / density;
    }
    if (phase.spectral()) this->path_.beta *= phase.ratio(cosine, this->path_.lambda);
    ray.direction = directionAbout(ray.direction, cosine, sample.bsdf.y);
    ++spread_;
    linkCount_ = kMostLinks + 1;
    return anyNonZero(this->path_.beta);
}

template <EffectBits E> bool LightLoop<E>::survives(std::uint32_t depth) {
    float p = 1;
    if (depth >= 3) {
        float throughput = mean(abs(this->path_.beta)) / startThroughput_;
        if constexpr (Base::kMedia) throughput /= mean(this->path_.densities.unidirectional);
        p = std::min(depth >= Base::kLongPath ? this->longSurvival(depth) : 1.f,
                     std::clamp(throughput, RouletteReference::kFloor, 1.f));
    }
    if (spread_ > 0 && !raysAtSpread_) {
        raysAtSpread_ = rays();
        if (!photons_) p *= this->context_.traced->afterSpread;
    }
    if (p >= 1) return true;
    if (this->sampler_.roulette(depth) >= p) return false;
    this->path_.beta *= 1 / p;
    return true;
}

} // namespace abbe

#include "integrators/light_loop_photons.h"
