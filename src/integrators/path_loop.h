// The one path loop. Estimators follow [Veach1997, ch. 8–10] for multiple importance sampling and [Wilkie2014] for
// the wavelengths; notation of docs/conventions.md.
#pragma once

#include "base/arena.h"
#include "integrators/light_sampler.h"
#include "integrators/path_state.h"
#include "integrators/roulette.h"
#include "integrators/sampler.h"
#include "render/integrator.h"
#include "render/scene.h"

namespace abbe {

// Everything that the paths of one render share.
struct PathContext {
    const Scene& scene;
    const LightSampler& lights;
    RenderSettings settings;
    bool choices = true; // whether anything in the scene draws a light, a lobe or a place on a lens
};

// What the paths of one tile counted.
struct PathCounters {
    std::uint64_t paths = 0, vertices = 0, shadowRays = 0, capped = 0;
};

// Radiance along one camera ray at the path's wavelengths.
template <EffectBits E> class PathLoop {
  public:
    // No path is longer: with a survival floor of 0.05 a path of this length has a probability below any machine's
    // patience only if every surface reflects everything; such paths are counted, never silent.
    static constexpr std::uint32_t kMaxVertices = 100'000;
    // From here on no path is certain to go on.
    static constexpr std::uint32_t kLongPath = 64;

    PathLoop(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters)
        : context_(context), sampler_(sampler), arena_(arena), counters_(counters) {}

    // The camera ray is that of the hero alone; to be called before radiance().
    void startWithHero() { startWithHero_ = true; }
    // `rouletteScale` of the pixel, see RouletteReference.
    Spectrum radiance(Ray ray, const Wavelengths& lambda, float rouletteScale);

  private:
    static constexpr bool kDispersion = hasEffect(E, Effect::dispersion);
    static constexpr bool kAbsorption = hasEffect(E, Effect::absorption);
    using Strategy = RenderSettings::Strategy;

    // Towards the eye, in the shading frame and in render space.
    struct Directions {
        Vec3 wo;
        Vec3 woRender;
    };

    void meetLight(const SurfaceHit&, Vec3 direction);
    void leaveScene(Vec3 direction);
    void sampleLight(const SurfaceHit&, const Bsdf&, const Directions&, const VertexSample&);
    bool scatter(const SurfaceHit&, const BsdfSample&, const Directions&, Ray&);
    bool survives(std::uint32_t depth, float rouletteScale);
    void absorb(const SurfaceHit&, Vec3 direction);
    // What a ray that crosses the surface towards `w` runs in; null in air.
    static const Curve* absorptionBeyond(const SurfaceHit& hit, Vec3 w) {
        return dot(w, hit.ng) < 0 ? hit.material->absorption() : nullptr;
    }
    void endSecondaryWavelengths();
    // False where the shading normal would let light through a surface or keep it from crossing one.
    static bool sidesAgree(const SurfaceHit&, const Directions&, Vec3 wi, Vec3 wiRender);
    // 1 / mean of the spectral balance heuristic for a contribution found by scattering, when next-event estimation
    // would have found it with density `lightPdf` (0: could not).
    float scatteringWeight(float lightPdf) const;
    // The same for a contribution found on a light with density `lightPdf`, when the BSDF's is `eval`.
    float lightWeight(float lightPdf, const BsdfEval& eval, bool delta) const;

    const PathContext& context_;
    Sampler& sampler_;
    Arena& arena_;
    PathCounters& counters_;
    PathState<E> path_;
    bool startWithHero_ = false;
};

template <EffectBits E> Spectrum PathLoop<E>::radiance(Ray ray, const Wavelengths& lambda, float rouletteScale) {
    path_.lambda = lambda;
    path_.time = ray.time;
    if constexpr (kDispersion) {
        path_.densities.film = lambda;
        if (startWithHero_) endSecondaryWavelengths();
    }
    const std::uint32_t maxDepth = context_.settings.maxDepth ? context_.settings.maxDepth : kMaxVertices;
    SurfaceHit hit;
    for (std::uint32_t depth = 0;; ++depth) {
        ++counters_.vertices;
        if (!context_.scene.intersector->intersect(ray, hit)) {
            leaveScene(ray.direction);
            break;
        }
        if constexpr (kAbsorption) absorb(hit, ray.direction);
        if (hit.light) meetLight(hit, ray.direction);
        if (depth >= maxDepth) {
            counters_.capped += context_.settings.maxDepth == 0;
            break;
        }
        arena_.reset();
        const Bsdf& bsdf = *hit.material->bsdf(hit, path_.lambda, arena_);
        const Directions eye{hit.shading.toLocal(-ray.direction), -ray.direction};
        const VertexSample sample = sampler_.vertex(depth);
        // Drawn before the shadow ray, so that the two chains of arithmetic overlap in the processor.
        const auto next = bsdf.sample(eye.wo, sample.lobe, sample.bsdf, Transport::radiance);
        sampleLight(hit, bsdf, eye, sample);
        if (!next || !scatter(hit, *next, eye, ray) || !survives(depth, rouletteScale)) break;
    }
    return path_.radiance;
}

template <EffectBits E>
bool PathLoop<E>::sidesAgree(const SurfaceHit& hit, const Directions& eye, Vec3 wi, Vec3 wiRender) {
    const bool reflectsGeometrically = dot(eye.woRender, hit.ng) * dot(wiRender, hit.ng) > 0;
    return (eye.wo.z * wi.z > 0) == reflectsGeometrically;
}

template <EffectBits E> float PathLoop<E>::scatteringWeight(float lightPdf) const {
    if constexpr (kDispersion) {
        const auto& d = path_.densities;
        return 1 / mean(fma(d.before, Spectrum(lightPdf / path_.bsdfPdf), d.unidirectional));
    }
    return 1 / (1 + lightPdf / path_.bsdfPdf);
}

template <EffectBits E> float PathLoop<E>::lightWeight(float lightPdf, const BsdfEval& eval, bool delta) const {
    const float ratio = delta || context_.settings.strategy == Strategy::lightsOnly ? 0 : eval.pdfSolidAngle / lightPdf;
    if constexpr (kDispersion) {
        const Spectrum& r = path_.densities.unidirectional;
        return 1 / mean(fma(r * ratio, eval.pdfRatio, r));
    }
    return 1 / (1 + ratio);
}

template <EffectBits E> void PathLoop<E>::meetLight(const SurfaceHit& hit, Vec3 direction) {
    const Spectrum emitted = hit.light->emitted(hit, -direction, path_.lambda);
    const Strategy strategy = context_.settings.strategy;
    if (strategy == Strategy::lightsOnly && !path_.delta) return;
    float lightPdf = 0;
    if (!path_.delta && strategy == Strategy::mis)
        lightPdf = context_.lights.probability(hit.light) * hit.light->pdfSolidAngle(path_.from, hit, path_.time);
    const float weight = path_.delta ? scatteringWeight(0) : scatteringWeight(lightPdf);
    path_.radiance = fma(path_.beta * weight, emitted, path_.radiance);
}

template <EffectBits E> void PathLoop<E>::leaveScene(Vec3 direction) {
    const Strategy strategy = context_.settings.strategy;
    if (strategy == Strategy::lightsOnly && !path_.delta) return;
    for (const Light* light : context_.lights.infinite()) {
        float lightPdf = 0;
        if (!path_.delta && strategy == Strategy::mis)
            lightPdf = context_.lights.probability(light) * light->pdfEscaped(direction, path_.time);
        const Spectrum arriving = light->escaped(direction, path_.lambda, path_.time);
        path_.radiance = fma(path_.beta * scatteringWeight(lightPdf), arriving, path_.radiance);
    }
}

template <EffectBits E>
void PathLoop<E>::sampleLight(const SurfaceHit& hit, const Bsdf& bsdf, const Directions& eye,
                              const VertexSample& sample) {
    if (context_.settings.strategy == Strategy::bsdfOnly || context_.lights.empty()) return;
    if (!bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // delta lobes meet no sampled direction
    const PickedLight picked = context_.lights.pick(sample.pick);
    const auto light = picked.light->sample(hit.p, sample.light, path_.lambda, path_.time);
    if (!light) return;
    const Vec3 wi = hit.shading.toLocal(light->wi);
    const BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
    if (!anyNonZero(eval.fcos) || !sidesAgree(hit, eye, wi, light->wi)) return;
    ++counters_.shadowRays;
    // From the moved origin to the light's own moved point: neither surface shadows itself.
    const Vec3 origin = spawnOrigin(hit, light->wi);
    const Intersector& world = *context_.scene.intersector;
    if (light->distance < kInfinity ? world.occluded(origin, light->p, path_.time)
                                    : world.occluded({origin, light->wi, kInfinity, path_.time}))
        return;
    const float pdf = picked.probability * light->pdfSolidAngle;
    Spectrum contribution = path_.beta * eval.fcos * light->radiance * (lightWeight(pdf, eval, light->delta) / pdf);
    if constexpr (kAbsorption) {
        const Curve* medium = eye.wo.z * wi.z < 0 ? absorptionBeyond(hit, light->wi) : path_.interior.absorption;
        if (medium && light->distance < kInfinity) contribution *= exp(medium->at(path_.lambda) * -light->distance);
    }
    path_.radiance += contribution;
}

template <EffectBits E>
bool PathLoop<E>::scatter(const SurfaceHit& hit, const BsdfSample& next, const Directions& eye, Ray& ray) {
    path_.beta *= next.weight;
    path_.from = hit.p;
    path_.bsdfPdf = next.pdfSolidAngle;
    path_.delta = next.lobe.has(Lobe::delta);
    path_.etaScale *= next.eta * next.eta;
    if constexpr (kDispersion) {
        auto& d = path_.densities;
        if (path_.delta && next.lobe.has(Lobe::dispersive)) endSecondaryWavelengths();
        d.before = d.unidirectional;
        if (!path_.delta) d.unidirectional *= next.pdfRatio;
    }
    const Vec3 direction = hit.shading.toWorld(next.wi);
    if (!sidesAgree(hit, eye, next.wi, direction)) return false;
    if constexpr (kAbsorption)
        if (next.lobe.has(Lobe::transmission)) path_.interior.absorption = absorptionBeyond(hit, direction);
    ray = {spawnOrigin(hit, direction), direction, kInfinity, path_.time};
    return anyNonZero(path_.beta);
}

template <EffectBits E> bool PathLoop<E>::survives(std::uint32_t depth, float rouletteScale) {
    if (depth == 0) return true; // the first bounce carries most of the image
    const float throughput = mean(path_.beta) * path_.etaScale;
    // Mirrors and clear glass show the pixel what it sees: there the expected radiance is the pixel's, not the image's.
    const float scale = path_.delta ? std::max(rouletteScale, 1 / RouletteReference::kThreshold) : rouletteScale;
    float p = RouletteReference::survival(throughput, scale);
    // Total reflection in a clear solid can trap a path that loses nothing. Close to 1, because roulette against an
    // albedo ρ has finite variance only for p > ρ².
    if (depth >= kLongPath) p = std::min(p, 0.999f);
    if (p >= 1) return true;
    if (sampler_.roulette(depth) >= p) return false;
    path_.beta *= 1 / p;
    return true;
}

// Beer–Lambert along the segment that ends at `hit`. A camera inside a dielectric is known by its first hit: a boundary
// met from behind while no interior was entered.
template <EffectBits E> void PathLoop<E>::absorb(const SurfaceHit& hit, Vec3 direction) {
    const Curve*& absorption = path_.interior.absorption;
    if (!absorption && dot(direction, hit.ng) > 0) absorption = hit.material->absorption();
    if (absorption) path_.beta *= exp(absorption->at(path_.lambda) * -hit.distance);
}

// The direction just taken belongs to the hero alone: the densities of all other lanes are 0, so that the mean of the
// ratios is 1/8 of the hero's and the hero counts eightfold. From here on every lane evaluates the hero's wavelength,
// which keeps means over lanes (lobe choices, roulette) meaningful; only lane 0 still adds to the image.
template <EffectBits E> void PathLoop<E>::endSecondaryWavelengths() {
    if (path_.densities.heroOnly) return;
    path_.densities.heroOnly = true;
    const float hero = path_.beta[0] * (static_cast<float>(kLanes) / path_.densities.unidirectional[0]);
    path_.beta = Spectrum(Float8{hero, 0, 0, 0, 0, 0, 0, 0});
    path_.densities.unidirectional = Spectrum(1.f);
    path_.lambda.keepHero();
}

} // namespace abbe
