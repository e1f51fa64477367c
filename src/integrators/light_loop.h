// Paths that start at the lights: every vertex at which light spreads is seen by the camera [Veach1997, ch. 10;
// Arvo1986].
#pragma once

#include "integrators/emitted_ray.h"
#include "integrators/path_loop.h"
#include "render/light_vertex.h"

namespace abbe {

// What a vertex of a light path adds to the picture.
struct Splat {
    Vec2 film;      // as CameraSample::film
    Spectrum value; // pixels · radiance at the wavelengths that the path started with: its mean over all light paths,
                    // per unit of the filter's integral, is the picture
};

// One path from a light through the scene. It is walked as paths from the camera are, through the same media and
// boundaries; light that it brings to media that shine or to other lights is not its own. Requires kInterfaces.
template <EffectBits E> class LightLoop : private PathLoop<E> {
    using Base = PathLoop<E>;

  public:
    using Media = typename Base::Media;
    using Base::makeMedia;

    // Two arenas, as LightVertex asks for them. In the context asksLights is false.
    LightLoop(const PathContext& context, Sampler& sampler, Arena& arena, Arena& eye, PathCounters& counters,
              Media& media)
        : Base(context, sampler, arena, counters, media), eye_(eye) {}

    void startIn(const Surroundings& around) { this->path_.nested.here = around; }
    // Vertex 0 of the sampler has started the path; vertex k + 1 is that of the path's vertex k.
    template <typename Tell> void trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell);

  private:
    static constexpr bool kDispersion = hasEffect(E, Effect::dispersion);

    template <typename Tell> void show(const SurfaceHit&, const LightVertex&, Vec2 lens, std::uint32_t depth, Tell&&);
    template <typename Tell> void showMedium(Vec3 p, Vec3 direction, Vec2 lens, std::uint32_t depth, Tell&&);
    template <typename Tell> void addSplat(const LensConnection&, const Spectrum& value, Tell&&);
    std::optional<LensConnection> connect(Vec3 p, Vec2 lens) const;
    Spectrum passing(Vec3 origin, const LensConnection&, bool through, std::uint32_t depth);
    bool scatter(const SurfaceHit&, const LightVertex&, const VertexSample&, Ray&);
    bool scatterInMedium(Ray&, const VertexSample&);
    bool survives(std::uint32_t depth);

    Arena& eye_;
    float startThroughput_ = 1;
};

template <EffectBits E>
template <typename Tell>
void LightLoop<E>::trace(const EmittedRay& start, const Wavelengths& lambda, Tell&& tell) {
    auto& path = this->path_;
    path.lambda = lambda;
    path.time = start.ray.time;
    path.beta = start.beta;
    path.delta = false;
    startThroughput_ = std::max(mean(start.beta), std::numeric_limits<float>::min());
    if constexpr (kDispersion) path.densities.film = lambda;
    const auto& settings = this->context_.settings;
    const std::uint32_t most = settings.maxDepth ? settings.maxDepth : Base::kMaxVertices;
    Ray ray = start.ray;
    SurfaceHit hit;
    for (std::uint32_t depth = 0; depth < most; ++depth) {
        this->countRay();
        const auto arrival = this->arrive(ray, hit, depth + 1);
        if (arrival == Base::Arrival::nowhere || !anyNonZero(path.beta)) return;
        const VertexSample sample = this->sampler_.vertex(depth + 1);
        if (arrival == Base::Arrival::collision) {
            showMedium(ray.origin, ray.direction, sample.light, depth, tell);
            if (!scatterInMedium(ray, sample) || !survives(depth)) return;
            continue;
        }
        if (!hit.material->reversible()) return;
        hit.arrival = ray.direction;
        hit.footprint = 0;
        this->arena_.reset();
        const LightVertex vertex(hit, path.lambda, this->arena_, eye_);
        show(hit, vertex, sample.light, depth, tell);
        if (!scatter(hit, vertex, sample, ray) || !survives(depth)) return;
    }
}

template <EffectBits E> std::optional<LensConnection> LightLoop<E>::connect(Vec3 p, Vec2 lens) const {
    const Scene& scene = this->context_.scene;
    const auto& f = scene.frame;
    constexpr float kMargin = 8; // pixels: as far as filters reach
    const LensQuery query{p,
                          lens,
                          this->path_.time,
                          this->path_.lambda.nm[0],
                          {static_cast<float>(f.x0) - kMargin, static_cast<float>(f.y0) - kMargin},
                          {static_cast<float>(f.x1) + kMargin, static_cast<float>(f.y1) + kMargin}};
    return scene.camera->connect(query);
}

// Of what lies between a vertex and the lens.
template <EffectBits E>
Spectrum LightLoop<E>::passing(Vec3 origin, const LensConnection& c, bool through, std::uint32_t depth) {
    const LightSample end(c.wi, c.lens, c.distance, Spectrum(1.f), 1);
    ++this->counters_.shadowRays;
    return this->transmittance(origin, end, {this->path_.nested.after(through), {}},
                               this->sampler_.stream(2 * depth + 3));
}

template <EffectBits E>
template <typename Tell>
void LightLoop<E>::show(const SurfaceHit& hit, const LightVertex& vertex, Vec2 lens, std::uint32_t depth, Tell&& tell) {
    if (!vertex.bsdf().lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // deltas meet no lens
    const auto c = connect(hit.p, lens);
    if (!c) return;
    const LightScattering s = vertex.towards(c->wi);
    if (!anyNonZero(s.fcos)) return;
    const bool through = dot(c->wi, hit.ng) * dot(hit.arrival, hit.ng) > 0;
    const Spectrum clear = passing(spawnOrigin(hit, c->wi), *c, through, depth);
    if (anyNonZero(clear)) addSplat(*c, this->path_.beta * s.fcos * clear, tell);
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
        if (anyNonZero(clear)) addSplat(*c, this->path_.beta * clear, tell);
    }
}

// The balance of the wavelengths: means over all that could have been the hero [Wilkie2014].
template <EffectBits E>
template <typename Tell>
void LightLoop<E>::addSplat(const LensConnection& c, const Spectrum& value, Tell&& tell) {
    Spectrum seen = value * c.importance;
    if constexpr (kDispersion) {
        const Spectrum& densities = this->path_.densities.unidirectional;
        if (c.heroOnly && !this->path_.densities.heroOnly)
            seen = Spectrum(Float8{seen[0] * static_cast<float>(kLanes) / densities[0], 0, 0, 0, 0, 0, 0, 0});
        else
            seen *= 1 / mean(densities);
    }
    tell(Splat{c.film, seen});
}

template <EffectBits E>
bool LightLoop<E>::scatter(const SurfaceHit& hit, const LightVertex& vertex, const VertexSample& sample, Ray& ray) {
    auto& path = this->path_;
    const auto next = vertex.sample(sample.lobe, sample.bsdf);
    if (!next) return false;
    const LightScattering& s = next->scattering;
    path.beta *= s.fcos * (1 / s.pdfSolidAngle);
    if constexpr (kDispersion) {
        const bool delta = next->lobe.has(Lobe::delta);
        if (delta && next->lobe.has(Lobe::dispersive)) this->endSecondaryWavelengths();
        if (!delta) path.densities.unidirectional *= Spectrum(s.pdfRatio);
    }
    if (next->lobe.has(Lobe::transmission)) path.nested.here = path.nested.beyond;
    ray = {spawnOrigin(hit, next->away), next->away, kInfinity, path.time};
    return anyNonZero(path.beta);
}

template <EffectBits E> bool LightLoop<E>::scatterInMedium(Ray& ray, const VertexSample& sample) {
    const PhaseFunction& phase = this->collided_->phase();
    const float cosine = phase.sampleCosine(sample.bsdf.x);
    const float sine = safeSqrt((1 - cosine) * (1 + cosine)), azimuth = 2 * kPi * sample.bsdf.y;
    if (phase.spectral()) this->path_.beta *= phase.ratio(cosine, this->path_.lambda);
    const Frame frame = Frame::fromNormal(ray.direction);
    ray.direction = normalize(frame.toWorld({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine}));
    return anyNonZero(this->path_.beta);
}

template <EffectBits E> bool LightLoop<E>::survives(std::uint32_t depth) {
    if (depth < 3) return true;
    float throughput = mean(abs(this->path_.beta)) / startThroughput_;
    if constexpr (kDispersion && Base::kMedia) throughput /= mean(this->path_.densities.unidirectional);
    const float p = std::min(depth >= Base::kLongPath ? Base::longPathSurvival(depth) : 1.f,
                             std::clamp(throughput, RouletteReference::kFloor, 1.f));
    if (p >= 1) return true;
    if (this->sampler_.roulette(depth) >= p) return false;
    this->path_.beta *= 1 / p;
    return true;
}

} // namespace abbe
