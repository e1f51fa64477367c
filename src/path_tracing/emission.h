// Light that camera paths hit: of surfaces, of media on the way, and from where there is nothing more.
#pragma once

#include "light_sampling/light_sampler.h"
#include "path_tracing/mis_weights.h"
#include "path_tracing/split_visibility.h"

namespace abbe {

// Weighed against next-event estimation at the last vertex, and against all that finds caustics. All three outlive it.
template <EffectBits E> class Emission {
    static constexpr bool kLightPaths = PathWalk<E>::kLightPaths;

  public:
    Emission(PathWalk<E>& walk, const CameraVertex& last, CameraCaustics<E>& caustics)
        : walk_(walk), last_(last), caustics_(caustics) {}

    void addSurface(const SurfaceHit&, Vec3 direction);
    void leaveScene(const Ray&);
    // Adds up what media give off along a ray.
    class OfMedia;

  private:
    // `hit`: as LightPathWeights::emissionWeight() takes it.
    template <typename... Hit> float weight(float lightPdf, [[maybe_unused]] const Hit&... hit) const {
        if constexpr (kLightPaths)
            if (caustics_.lightPaths.weighs()) return caustics_.lightPaths.emissionWeight(lightPdf, hit...);
        return walk_.path.delta ? scatteringWeight(walk_, 0) : scatteringWeight(walk_, lightPdf);
    }

    PathWalk<E>& walk_;
    const CameraVertex& last_;
    CameraCaustics<E>& caustics_;
};

template <EffectBits E> void Emission<E>::addSurface(const SurfaceHit& hit, Vec3 direction) {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    if (context.scene.hidden.splits && !reachedByShadowRays(walk_, last_.origin, hit, direction)) [[unlikely]]
        return;
    const Spectrum emitted = hit.light->emitted(hit, -direction, path.lambda);
    float lightPdf = 0;
    if (rivalled(walk_, last_))
        lightPdf = lightShare<E>(last_) *
                   context.lights.probability(hit.light, hit.light->partOf(hit), last_.receiver, last_.scatters,
                                              context.arrival) *
                   hit.light->pdfSolidAngle(last_.receiver, hit, path.time);
    estimate.checkDensities(lightPdf, path.bsdfPdf);
    if constexpr (kLightPaths)
        if (caustics_.leaveOut(hit)) return;
    const float w = weight(lightPdf, hit, direction);
    estimate.add(path.beta * w * emitted, hit.light, false,
                 [&] { estimate.observer->hits(hit.light, emitted, lightPdf); });
}

template <EffectBits E> void Emission<E>::leaveScene(const Ray& ray) {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    const Vec3 direction = ray.direction;
    setWork(Work::lights);
    if (estimate.observer) [[unlikely]]
        estimate.observer->leaves(direction);
    estimate.checkDirection(direction);
    if (context.scene.hidden.splits && !reachedByShadowRays(walk_, last_.origin, ray, kInfinity)) [[unlikely]]
        return;
    for (const DistantLight* light : context.lights.infinite()) {
        if (!light->visible().has(ray.kind)) continue;
        float lightPdf = 0;
        if (rivalled(walk_, last_))
            lightPdf = lightShare<E>(last_) *
                       context.lights.probability(light, 0, last_.receiver, last_.scatters, context.arrival) *
                       light->pdfEscaped(last_.receiver, direction, path.time);
        estimate.checkDensities(lightPdf, path.bsdfPdf);
        const Spectrum arriving = light->escaped(direction, path.lambda, path.time);
        if constexpr (kLightPaths)
            if (caustics_.leaveOut(*light, direction)) continue;
        const float w = weight(lightPdf, *light, last_.receiver.p, direction);
        estimate.add(path.beta * w * arriving, light, false,
                     [&] { estimate.observer->hits(light, arriving, lightPdf); });
    }
}

template <EffectBits E> class Emission<E>::OfMedia final : public EmissionListener {
  public:
    OfMedia(PathWalk<E>& walk, const CameraVertex& last, const Ray& ray) : walk_(walk), last_(last), ray_(ray) {
        minds = walk.estimate.observer != nullptr;
    }

    void absorbs(float t, float share) override {
        walk_.estimate.observer->absorbs(ray_.origin + ray_.direction * t, share);
    }

    void emits(const MediumEmission& emission, float t, const Spectrum& amount, const Spectrum& beta,
               const Spectrum& density) override {
        const PathContext& context = walk_.context;
        RadianceEstimate& estimate = walk_.estimate;
        if (context.scene.hidden.splits && !reachedByShadowRays(walk_, last_.origin, ray_, t)) [[unlikely]]
            return;
        float lightPdf = 0;
        if (rivalled(walk_, last_))
            lightPdf = lightShare<E>(last_) *
                       context.lights.probability(&emission, last_.receiver, last_.scatters, context.arrival) *
                       emission.pdfSolidAngle(last_.receiver.p, ray_.origin + ray_.direction * t);
        estimate.checkDensity(lightPdf);
        Spectrum arriving = beta * amount * scatteringWeight(walk_, lightPdf, density);
        arriving *= walk_.clearness(walk_.path.nested.here, t);
        estimate.add(arriving, &emission, false, [&] {
            estimate.observer->lightsUp(ray_.origin + ray_.direction * t);
            estimate.observer->hits(&emission, amount, lightPdf);
        });
    }

  private:
    PathWalk<E>& walk_;
    const CameraVertex& last_;
    const Ray& ray_;
};

} // namespace abbe
