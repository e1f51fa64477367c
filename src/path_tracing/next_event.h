// Next-event estimation [Veach1997, sec. 8.3; Kulla2012]: a place on a light is drawn, and a shadow ray tells whether
// its light arrives.
#pragma once

#include "light_sampling/light_sampler.h"
#include "math/warp.h"
#include "path_tracing/mis_weights.h"
#include "path_tracing/split_visibility.h"

namespace abbe {

// Of a camera path: at surfaces, where it collides in media, and along its way towards lights near it. Weighed against
// scattering and against all that finds caustics. All three that it is given outlive it.
template <EffectBits E> class NextEvent {
    static constexpr bool kAbsorption = PathWalk<E>::kAbsorption;
    static constexpr bool kDispersion = PathWalk<E>::kDispersion;
    static constexpr bool kInterfaces = PathWalk<E>::kInterfaces;
    static constexpr bool kLightPaths = PathWalk<E>::kLightPaths;

  public:
    NextEvent(PathWalk<E>& walk, const CameraVertex& last, CameraCaustics<E>& caustics)
        : walk_(walk), last_(last), caustics_(caustics) {}

    void atSurface(const SurfaceHit&, const Bsdf&, const EyeDirection&, const VertexSample&, std::uint32_t depth);
    // Where tracking collided, from the direction.
    void inMedium(Vec3 p, Vec3 direction, const VertexSample&, std::uint32_t depth);
    // What light of the mean 1 over the path's wavelengths is of all that the pixel shows, roughly. While it is 0 every
    // shadow ray is followed to its end.
    void weighBy(float worth) requires(PathWalk<E>::kMedia) { worth_ = worth; }

    // The light at one place of the ray, before it is followed: distances drawn by how near they come to a light
    // [Kulla2012], beside those that tracking finds. In thin fog around a light tracking rarely stops where the light
    // is.
    //
    // Next-event estimation from there and from where tracking scatters share the place on their light, which leaves
    // the choice of the light and the distances to be weighed: those drawn here against those that tracking finds on
    // average, a function of the place alone. So both may estimate what lies between as they like. Only for rays that
    // the eye sees, directly or in mirrors and clear glass: further on it costs as much as before and is blurred
    // (docs/performance.md).
    void alongRay(const Ray&, float tMax, std::uint32_t depth, std::uint32_t crossings);
    // That ray was followed to a collision.
    void collideAt(float t) { leg_.collision = t; }

  private:
    // Of what a pixel shows: light in a medium that is less is looked for as much less often, and a transmittance that
    // makes it less is followed as much less often (docs/performance.md has the figures of other values).
    static constexpr float kWorth = 0.7f;

    // The way that the path is on, from a vertex or a boundary; `media` is empty where near lights are not looked for.
    struct Leg {
        Ray ray;
        RayExtent media;
        float collision = 0; // where it ended
    };

    float weight(const LightSample& light, const PickedLight& picked, const BsdfEval& eval,
                 [[maybe_unused]] Vec3 woRender) {
        if constexpr (kLightPaths)
            if (const auto w = caustics_.lightPaths.neeWeight(light, picked, woRender)) return *w;
        return neeWeight(walk_, picked.probability * light.pdfSolidAngle, eval, light.delta);
    }
    // At the place `p` in a medium, whose phase function has the density `phase` of the light's direction, which
    // scattering there has with `pdf`.
    float weightInMedium(const LightSample& light, const PickedLight& picked, [[maybe_unused]] Vec3 p,
                         [[maybe_unused]] float phase, float pdf) {
        if constexpr (kLightPaths)
            if (const auto w = caustics_.lightPaths.neeWeightInMedium(light, picked, p, phase)) return *w;
        BsdfEval eval;
        eval.pdfSolidAngle = pdf;
        return neeWeight(walk_, picked.probability * light.pdfSolidAngle, eval, light.delta);
    }
    // Light for a place in a medium.
    struct LightInMedium {
        LightSample light;
        PickedLight picked;
        Spectrum contribution; // if nothing is in its way
        float expected;        // of that, mean of all candidates and wavelengths
        float weight = 1;      // for not being the only candidate
        float phase, pdf;      // densities of its direction: of the phase function, and its own
    };
    std::optional<LightInMedium> lightInMedium(Vec3 p, Vec3 direction, float pick, Vec2 u, std::uint32_t depth);
    std::optional<LightInMedium> chooseInMedium(Vec3 p, Vec3 direction, const VertexSample&, std::uint32_t depth,
                                                RandomStream&);
    std::optional<EquiangularDistances> distancesTowards(const Light&) const;
    float trackingShare(const PickedLight&);
    Spectrum scatteredAlongRay(const LightSample&, const PickedLight&, Vec3 p, std::uint32_t depth);

    PathWalk<E>& walk_;
    const CameraVertex& last_;
    CameraCaustics<E>& caustics_;
    [[no_unique_address]] std::conditional_t<PathWalk<E>::kMedia, Leg, NoState> leg_;
    float worth_ = 0;
};

template <EffectBits E>
void NextEvent<E>::atSurface(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye,
                             const VertexSample& sample, [[maybe_unused]] std::uint32_t depth) {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    if (!context.how.nextEvent || context.lights.empty()) return;
    if (!bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // deltas have no value for a light's direction
    const float share = lightShare<E>(last_);
    float u = sample.pick;
    if (share < 1) [[unlikely]] {
        if (u >= share) return;
        u /= share;
    }
    PickedLight picked =
        context.lights.pick(std::min(u, kOneMinusEpsilon), last_.receiver, last_.scatters, context.arrival);
    if (estimate.observer) [[unlikely]]
        estimate.observer->asks(last_.receiver, picked.light, picked.part);
    picked.probability *= share;
    auto light = picked.light->sample(last_.receiver, picked.part, sample.light, path.lambda, path.time);
    if (!light) return;
    const Vec3 wi = hit.shading.toLocal(light->wi);
    BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
    if (!anyNonZero(eval.fcos) || !walk_.sidesAgree(hit, eye, wi, light->wi))
        return estimate.checkDirection(light->wi, {picked.light, "direction"});
    ++walk_.counters.shadowRays;
    // From the moved origin to the light's own moved point: neither surface shadows itself.
    const Vec3 origin = spawnOrigin(hit, light->wi);
    const bool through = eye.wo.z * wi.z < 0;
    [[maybe_unused]] Spectrum passing;
    if constexpr (kInterfaces) {
        passing = walk_.transmittance(origin, *light, path.nested.after(through), walk_.sampler.stream(2 * depth + 1));
        if (!anyNonZero(passing)) return;
    } else if (walk_.occluded(origin, *light)) {
        return;
    }
    hideFromScattering(walk_, *light, *picked.light, origin);
    eval.pdfSolidAngle = last_.mixed(eval.pdfSolidAngle, light->wi); // last, as most lights are hidden where it counts
    const float pdf = picked.probability * light->pdfSolidAngle;
    estimate.checkDensities(pdf, eval.pdfSolidAngle);
    if constexpr (kDispersion) estimate.checkRatios(eval.pdfRatio);
    const float w = weight(*light, picked, eval, eye.woRender);
    Spectrum contribution = path.beta * eval.fcos * light->radiance * (w / pdf);
    if constexpr (kInterfaces) {
        contribution *= passing;
    } else if constexpr (kAbsorption) {
        const Curve* medium = through ? walk_.absorptionBeyond(hit, light->wi) : path.interior.absorption;
        if (medium && light->distance < kInfinity) contribution *= exp(medium->at(path.lambda) * -light->distance);
    }
    estimate.add(contribution, picked.light, false,
                 [&] { estimate.observer->samples(picked.light, *light, eval, pdf); });
}

template <EffectBits E>
void NextEvent<E>::inMedium(Vec3 p, Vec3 direction, const VertexSample& sample, std::uint32_t depth) {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    if (!context.how.nextEvent || context.lights.empty()) return;
    RandomStream random = walk_.sampler.stream(2 * depth + 1);
    const auto chosen = chooseInMedium(p, direction, sample, depth, random);
    if (!chosen) return;
    // As much as a ray brings in the mean decides whether it is followed, and how far.
    float weight = chosen->weight, least = 0;
    if (worth_ > 0) {
        const float share = worth_ * chosen->expected;
        if (share < kWorth) {
            if (!(random.uniform() * kWorth < share)) return;
            weight *= kWorth / share;
        }
        least = kWorth / std::max(share, kWorth);
    }
    ++walk_.counters.shadowRays;
    const Spectrum passing = walk_.transmittance(p, chosen->light, path.nested.here, random, RayKind::shadow, least);
    if (!anyNonZero(passing)) return;
    const PickedLight& picked = chosen->picked;
    estimate.add(chosen->contribution * passing * (weight * trackingShare(picked)), picked.light, false, [&] {
        const float value = chosen->phase;
        estimate.observer->samples(picked.light, chosen->light, {Spectrum(value), value}, chosen->pdf);
    });
}

// One light out of two that are drawn, in proportion to what they would give if nothing were in their way: what decides
// is the phase function, of which picking knows nothing [Talbot2005].
template <EffectBits E>
auto NextEvent<E>::chooseInMedium(Vec3 p, Vec3 direction, const VertexSample& sample, std::uint32_t depth,
                                  RandomStream& random) -> std::optional<LightInMedium> {
    const int candidates = walk_.context.lights.needsChoice() ? 2 : 1;
    std::optional<LightInMedium> chosen;
    float sum = 0;
    for (int i = 0; i < candidates; ++i) {
        const float pick = sample.pick + static_cast<float>(i) / static_cast<float>(candidates);
        auto light = lightInMedium(p, direction, pick < 1 ? pick : pick - 1, sample.light, depth);
        if (!light) continue;
        sum += light->expected;
        if (!chosen || random.uniform() * sum < light->expected) chosen = light;
    }
    if (!chosen) return chosen;
    sum /= static_cast<float>(candidates);
    chosen->weight = sum / chosen->expected;
    chosen->expected = sum;
    return chosen;
}

// Nothing where no light comes from.
template <EffectBits E>
auto NextEvent<E>::lightInMedium(Vec3 p, Vec3 direction, float pick, Vec2 u, std::uint32_t depth)
    -> std::optional<LightInMedium> {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    const PickedLight picked = context.lights.pick(pick, p);
    auto light = picked.light->sample(p, picked.part, u, path.lambda, path.time);
    if (!light) return std::nullopt;
    const PhaseFunction& phase = walk_.collided->phase();
    const float cosine = dot(direction, light->wi), value = phase.value(cosine);
    if (value == 0) return std::nullopt;
    hideFromScattering(walk_, *light, *picked.light, p);
    const float pdf = picked.probability * light->pdfSolidAngle;
    estimate.checkDensity(pdf);
    estimate.checkDensity(value, {walk_.collided, "phase function"});
    const float scattering = last_.mixed(context.how.mixedDensity(value, depth), light->wi);
    const float w = weightInMedium(*light, picked, p, value, scattering);
    Spectrum contribution = path.beta * light->radiance * (value * w / pdf);
    if (phase.spectral()) contribution *= phase.ratio(cosine, path.lambda);
    const float expected = mean(abs(contribution));
    if (expected == 0) return std::nullopt;
    return LightInMedium{*light, picked, contribution, expected, 1, value, pdf};
}

template <EffectBits E>
void NextEvent<E>::alongRay(const Ray& ray, float tMax, std::uint32_t depth, std::uint32_t crossings) {
    const PathContext& context = walk_.context;
    const auto& path = walk_.path;
    RadianceEstimate& estimate = walk_.estimate;
    MediumTracker& tracker = walk_.media.tracker;
    leg_.media = {};
    if (!context.lights.placed() || !path.delta || !context.how.nextEvent || !walk_.isLitHere() ||
        (context.settings.maxDepth && depth >= context.settings.maxDepth))
        return;
    leg_.ray = ray;
    leg_.media = tracker.extent(ray, tMax, path.nested.here.media());
    if (leg_.media.empty()) return;
    // Numbers of no vertex.
    const std::uint32_t set = (crossings + 1) << 20 | depth;
    const VertexSample sample = walk_.sampler.vertex(set);
    const PickedLight picked = context.lights.pickAlong(sample.pick, ray, leg_.media);
    const auto distances = distancesTowards(*picked.light);
    if (!distances) return;
    const float t = distances->sample(sample.bsdf.x), pdf = distances->pdf(t);
    const float tracked = tracker.expected(ray, t, path.nested.here.media(), path.lambda, &walk_.media.inScattering);
    const Vec3 p = ray.origin + ray.direction * t;
    const float pickedThere = context.lights.probability(picked.light, picked.part, p);
    const float share = picked.probability * pdf / (picked.probability * pdf + pickedThere * tracked);
    // Where tracking is as good there is no need to pay for both.
    const float kept = std::min(1.f, 4 * share);
    if (walk_.media.inScattering.empty() || sample.bsdf.y >= kept) return;
    auto light = picked.light->sample(p, picked.part, sample.light, path.lambda, path.time);
    if (!light) return;
    hideFromScattering(walk_, *light, *picked.light, p);

    const float lightPdf = pickedThere * light->pdfSolidAngle;
    PickedLight asTracking = picked;
    asTracking.probability = pickedThere;
    const Spectrum scattered = scatteredAlongRay(*light, asTracking, p, depth);
    if (!anyNonZero(scattered)) return;
    ++walk_.counters.shadowRays;
    Spectrum passing = walk_.transmittance(p, *light, path.nested.here, walk_.sampler.stream(2 * set + 1));
    if (!anyNonZero(passing)) return;
    RandomStream random = walk_.sampler.stream(2 * set);
    passing *= tracker.transmittance(ray, t, path.nested.here.media(), path.lambda, random);
    passing *= walk_.clearness(path.nested.here, t);
    if (estimate.observer) [[unlikely]]
        estimate.observer->lightsUp(p);
    const float density = kept * pdf * picked.probability * light->pdfSolidAngle;
    estimate.checkDensities(density, lightPdf);
    estimate.add(path.beta * light->radiance * scattered * passing * (share / density), picked.light, true, [&] {
        estimate.observer->samples(picked.light, *light, {scattered, 0}, density);
    });
}

// By all media at the place, weighed.
template <EffectBits E>
Spectrum NextEvent<E>::scatteredAlongRay(const LightSample& light, const PickedLight& picked, Vec3 p,
                                         std::uint32_t depth) {
    const PathContext& context = walk_.context;
    const float cosine = dot(leg_.ray.direction, light.wi);
    CameraVertex there; // if tracking collided
    if (context.guide) there.guide = context.guide->at(p, kInMedium);
    Spectrum scattered(0.f);
    for (const InScattering& at : walk_.media.inScattering) {
        const PhaseFunction& phase = at.medium->phase();
        const float density = phase.value(cosine);
        walk_.estimate.checkDensity(density, {at.medium, "phase function"});
        const float scattering = there.mixed(context.how.mixedDensity(density, depth), light.wi);
        const float w = weightInMedium(light, picked, p, density, scattering);
        Spectrum value = at.coefficient * (density * w);
        if (phase.spectral()) value *= phase.ratio(cosine, walk_.path.lambda);
        scattered += value;
    }
    return scattered;
}

// Of the leg, around where the light is; nothing where it is not looked for or does not arrive.
template <EffectBits E> std::optional<EquiangularDistances> NextEvent<E>::distancesTowards(const Light& light) const {
    if (leg_.media.empty()) return std::nullopt;
    const auto reach = light.reach(leg_.ray, leg_.media.tFar);
    if (!reach) return std::nullopt;
    const EquiangularDistances distances(leg_.ray.origin, leg_.ray.direction, reach->centre,
                                         std::max(leg_.media.tNear, reach->tNear),
                                         std::min(leg_.media.tFar, reach->tFar));
    return distances.valid() ? std::optional(distances) : std::nullopt;
}

// The weight of a light sampled where tracking collided: 1 but for lights that alongRay() samples too.
template <EffectBits E> float NextEvent<E>::trackingShare(const PickedLight& picked) {
    const auto distances = distancesTowards(*picked.light);
    if (!distances) return 1;
    const auto& path = walk_.path;
    const float pdf = distances->pdf(leg_.collision) *
                      walk_.context.lights.probabilityAlong(picked.light, picked.part, leg_.ray, leg_.media);
    if (pdf <= 0) return 1;
    const float tracked = walk_.media.tracker.expected(leg_.ray, leg_.collision, path.nested.here.media(), path.lambda);
    return picked.probability * tracked / (pdf + picked.probability * tracked);
}

} // namespace abbe
