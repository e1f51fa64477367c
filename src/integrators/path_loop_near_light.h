// Scattering towards lights near the path: distances drawn by how near they come to a light [Kulla2012], beside those
// that tracking finds. In thin fog around a lamp tracking rarely stops where the light is. Included by path_loop.h.
#pragma once

namespace abbe {

// The light at one place of the ray, before it is followed. Next-event estimation from there and from where tracking
// scatters share the place on their light, which leaves the choice of the light and the distances to be weighed: those
// drawn here against those that tracking finds on average, a function of the place alone. So both may estimate what
// lies between as they like. Only for rays that the eye sees, directly or in mirrors and clear glass: further on
// it costs as much as before and is blurred (docs/performance.md).
template <EffectBits E>
void PathLoop<E>::sampleNearLight(const Ray& ray, float tMax, std::uint32_t depth, std::uint32_t crossings) {
    auto& leg = media_.leg;
    const auto& settings = context_.settings;
    leg.media = {};
    if (!context_.lights.placed() || !path_.delta || !context_.how.asksLights ||
        (settings.maxDepth && depth >= settings.maxDepth))
        return;
    leg.ray = ray;
    leg.media = media_.tracker.extent(ray, tMax, path_.nested.here.media());
    if (leg.media.empty()) return;
    // Numbers of no vertex.
    const std::uint32_t set = (crossings + 1) << 20 | depth;
    const VertexSample sample = sampler_.vertex(set);
    const PickedLight picked = context_.lights.pickAlong(sample.pick, ray, leg.media);
    const auto distances = distancesTowards(*picked.light);
    if (!distances) return;
    const float t = distances->sample(sample.bsdf.x), pdf = distances->pdf(t);
    const float tracked =
        media_.tracker.expected(ray, t, path_.nested.here.media(), path_.lambda, &media_.inScattering);
    const Vec3 p = ray.origin + ray.direction * t;
    const float pickedThere = context_.lights.probability(picked.light, picked.part, p);
    const float share = picked.probability * pdf / (picked.probability * pdf + pickedThere * tracked);
    // Where tracking is as good there is no need to pay for both.
    const float kept = std::min(1.f, 4 * share);
    if (media_.inScattering.empty() || sample.bsdf.y >= kept) return;
    auto light = picked.light->sample(p, picked.part, sample.light, path_.lambda, path_.time);
    if (!light) return;
    hideFromScattering(*light, *picked.light, p);

    const float cosine = dot(ray.direction, light->wi), lightPdf = pickedThere * light->pdfSolidAngle;
    PickedLight asTracking = picked;
    asTracking.probability = pickedThere;
    Spectrum scattered(0.f);
    for (const InScattering& at : media_.inScattering) {
        const PhaseFunction& phase = at.medium->phase();
        const float density = phase.value(cosine);
        checkDensity(density, {at.medium, "phase function"});
        const float weight = askedInMedium(*light, asTracking, p, context_.how.mixedDensity(density, depth));
        Spectrum value = at.coefficient * (density * weight);
        if (phase.spectral()) value *= phase.ratio(cosine, path_.lambda);
        scattered += value;
    }
    if (!anyNonZero(scattered)) return;
    ++counters_.shadowRays;
    Spectrum passing = transmittance(p, *light, {path_.nested.here, {}}, sampler_.stream(2 * set + 1));
    if (!anyNonZero(passing)) return;
    RandomStream random = sampler_.stream(2 * set);
    passing *= media_.tracker.transmittance(ray, t, path_.nested.here.media(), path_.lambda, random);
    passing *= clearness(path_.nested.here, t);
    if (observer_) [[unlikely]]
        observer_->lightsUp(p);
    const float density = kept * pdf * picked.probability * light->pdfSolidAngle;
    checkDensities(density, lightPdf);
    gather(path_.beta * light->radiance * scattered * passing * (share / density), picked.light, true, [&] {
        observer_->asks(picked.light, *light, {scattered, 0}, density);
    });
}

// Of the leg, around where the light is; nothing where it is not looked for or does not arrive.
template <EffectBits E> std::optional<EquiangularDistances> PathLoop<E>::distancesTowards(const Light& light) const {
    const auto& leg = media_.leg;
    if (leg.media.empty()) return std::nullopt;
    const auto reach = light.reach(leg.ray, leg.media.tFar);
    if (!reach) return std::nullopt;
    const EquiangularDistances distances(leg.ray.origin, leg.ray.direction, reach->centre,
                                         std::max(leg.media.tNear, reach->tNear),
                                         std::min(leg.media.tFar, reach->tFar));
    return distances.valid() ? std::optional(distances) : std::nullopt;
}

// The weight of a light sampled where tracking collided: 1 but for lights that sampleNearLight() samples too.
template <EffectBits E> float PathLoop<E>::trackingShare(const PickedLight& picked) {
    const auto distances = distancesTowards(*picked.light);
    if (!distances) return 1;
    const auto& leg = media_.leg;
    const float pdf =
        distances->pdf(leg.collision) * context_.lights.probabilityAlong(picked.light, picked.part, leg.ray, leg.media);
    if (pdf <= 0) return 1;
    const float tracked = media_.tracker.expected(leg.ray, leg.collision, path_.nested.here.media(), path_.lambda);
    return picked.probability * tracked / (pdf + picked.probability * tracked);
}

} // namespace abbe
