// The part of the path loop for lights: those that paths meet, those that vertices ask, and the weights between both.
// Included by path_loop.h.
#pragma once

namespace abbe {

template <EffectBits E>
float PathLoop<E>::scatteringWeight(float lightPdf, [[maybe_unused]] const Spectrum& unidirectional) const {
    if constexpr (kDispersion) {
        const auto& d = path_.densities;
        if constexpr (kMedia) {
            // The two techniques are weighed by their directions alone, so that next-event estimation may estimate
            // transmittance as it likes; the balance of the wavelengths goes all the way.
            const float share =
                mean(d.direction) / mean(fma(d.before, Spectrum(lightPdf / path_.bsdfPdf), d.direction));
            return share / mean(unidirectional);
        }
        return 1 / mean(fma(d.before, Spectrum(lightPdf / path_.bsdfPdf), unidirectional));
    }
    return 1 / (1 + lightPdf / path_.bsdfPdf);
}

template <EffectBits E> float PathLoop<E>::lightWeight(float lightPdf, const BsdfEval& eval, bool delta) const {
    const float ratio =
        delta || context_.settings.technique.strategy == Strategy::lightsOnly ? 0 : eval.pdfSolidAngle / lightPdf;
    if constexpr (kDispersion) {
        const Spectrum& r = path_.densities.unidirectional;
        return 1 / mean(fma(r * ratio, eval.pdfRatio, r));
    }
    return 1 / (1 + ratio);
}

template <EffectBits E> void PathLoop<E>::meetLight(const SurfaceHit& hit, Vec3 direction) {
    const Spectrum emitted = hit.light->emitted(hit, -direction, path_.lambda);
    const Strategy strategy = context_.settings.technique.strategy;
    if (strategy == Strategy::lightsOnly && !path_.delta) return;
    float lightPdf = 0;
    if (!path_.delta && strategy == Strategy::mis)
        lightPdf = context_.lights.probability(hit.light, hit.light->partOf(hit), path_.from, path_.scatters) *
                   hit.light->pdfSolidAngle(path_.from, hit, path_.time);
    checkDensities(lightPdf, path_.bsdfPdf);
    const float weight = path_.delta ? scatteringWeight(0) : scatteringWeight(lightPdf);
    gather(path_.beta * weight * emitted, hit.light, false, [&] { observer_->meets(hit.light, emitted, lightPdf); });
}

template <EffectBits E> void PathLoop<E>::leaveScene(Vec3 direction) {
    if (observer_) [[unlikely]]
        observer_->leaves(direction);
    checkDirection(direction);
    const Strategy strategy = context_.settings.technique.strategy;
    if (strategy == Strategy::lightsOnly && !path_.delta) return;
    for (const Light* light : context_.lights.infinite()) {
        float lightPdf = 0;
        if (!path_.delta && strategy == Strategy::mis)
            lightPdf = context_.lights.probability(light, 0, path_.from, path_.scatters) *
                       light->pdfEscaped(path_.from, direction, path_.time);
        checkDensities(lightPdf, path_.bsdfPdf);
        const Spectrum arriving = light->escaped(direction, path_.lambda, path_.time);
        gather(path_.beta * scatteringWeight(lightPdf) * arriving, light, false,
               [&] { observer_->meets(light, arriving, lightPdf); });
    }
}

template <EffectBits E>
void PathLoop<E>::sampleLight(const SurfaceHit& hit, const Bsdf& bsdf, const Directions& eye,
                              const VertexSample& sample, [[maybe_unused]] std::uint32_t depth) {
    if (context_.settings.technique.strategy == Strategy::bsdfOnly || context_.lights.empty()) return;
    if (!bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // delta lobes meet no sampled direction
    const PickedLight picked = context_.lights.pick(sample.pick, path_.from, path_.scatters);
    const auto light = picked.light->sample(path_.from, picked.part, sample.light, path_.lambda, path_.time);
    if (!light) return;
    const Vec3 wi = hit.shading.toLocal(light->wi);
    const BsdfEval eval = bsdf.eval(eye.wo, wi, Transport::radiance);
    if (!anyNonZero(eval.fcos) || !sidesAgree(hit, eye, wi, light->wi))
        return checkDirection(light->wi, {picked.light, "direction"});
    ++counters_.shadowRays;
    // From the moved origin to the light's own moved point: neither surface shadows itself.
    const Vec3 origin = spawnOrigin(hit, light->wi);
    const bool through = eye.wo.z * wi.z < 0;
    [[maybe_unused]] Spectrum passing;
    if constexpr (kInterfaces) {
        passing = transmittance(origin, *light, {path_.nested.after(through), {}}, sampler_.stream(2 * depth + 1));
        if (!anyNonZero(passing)) return;
    } else if (occluded(origin, *light)) {
        return;
    }
    const float pdf = picked.probability * light->pdfSolidAngle;
    checkDensities(pdf, eval.pdfSolidAngle);
    if constexpr (kDispersion) checkRatios(eval.pdfRatio);
    Spectrum contribution = path_.beta * eval.fcos * light->radiance * (lightWeight(pdf, eval, light->delta) / pdf);
    if constexpr (kInterfaces) {
        contribution *= passing;
    } else if constexpr (kAbsorption) {
        const Curve* medium = through ? absorptionBeyond(hit, light->wi) : path_.interior.absorption;
        if (medium && light->distance < kInfinity) contribution *= exp(medium->at(path_.lambda) * -light->distance);
    }
    gather(contribution, picked.light, false, [&] { observer_->asks(picked.light, *light, eval, pdf); });
}

} // namespace abbe
