// The part of the path loop for lights: those that paths meet, those that vertices ask, and the weights between both.
// Included by path_loop.h.
#pragma once

namespace abbe {

// Where not the balance heuristic decides between the two techniques but another rule (LoopTechnique::odds), that of
// the wavelengths stays within each: their densities are means over all wavelengths that could have been the hero
// [Wilkie2014]. The weights are then functions of the path, the same from either side, and sum to 1.
template <EffectBits E>
float PathLoop<E>::scatteringWeight(float lightPdf, [[maybe_unused]] const Spectrum& unidirectional) const {
    float ratio = lightPdf / path_.bsdfPdf;
    if constexpr (kDispersion) {
        const auto& d = path_.densities;
        // In media the two are weighed by their directions alone, so that next-event estimation may estimate
        // transmittance as it likes; the balance of the wavelengths goes all the way.
        if (!context_.how.balanced) [[unlikely]] {
            const float own = kMedia ? mean(d.direction) : mean(unidirectional);
            return 1 / (1 + context_.how.odds(mean(d.before) * ratio / own, false)) / mean(unidirectional);
        }
        if constexpr (kMedia) {
            const float share = mean(d.direction) / mean(fma(d.before, Spectrum(ratio), d.direction));
            return share / mean(unidirectional);
        }
        return 1 / mean(fma(d.before, Spectrum(ratio), unidirectional));
    }
    if (!context_.how.balanced) [[unlikely]]
        ratio = context_.how.odds(ratio, false);
    return 1 / (1 + ratio);
}

template <EffectBits E> float PathLoop<E>::lightWeight(float lightPdf, const BsdfEval& eval, bool delta) const {
    float ratio = delta ? 0 : eval.pdfSolidAngle / lightPdf;
    if constexpr (kDispersion) {
        const Spectrum& r = path_.densities.unidirectional;
        if (!context_.how.balanced) [[unlikely]]
            return 1 / (1 + context_.how.odds(mean(r * eval.pdfRatio) * ratio / mean(r), true)) / mean(r);
        return 1 / mean(fma(r * ratio, eval.pdfRatio, r));
    }
    if (!context_.how.balanced) [[unlikely]]
        ratio = context_.how.odds(ratio, true);
    return 1 / (1 + ratio);
}

template <EffectBits E> void PathLoop<E>::meetLight(const SurfaceHit& hit, Vec3 direction) {
    if (context_.scene.hidden.splits && !arrivesAlike(hit, direction)) [[unlikely]]
        return;
    const Spectrum emitted = hit.light->emitted(hit, -direction, path_.lambda);
    float lightPdf = 0;
    if (!path_.delta && context_.how.asksLights)
        lightPdf = context_.lights.probability(hit.light, hit.light->partOf(hit), path_.from, path_.scatters) *
                   hit.light->pdfSolidAngle(path_.from, hit, path_.time);
    checkDensities(lightPdf, path_.bsdfPdf);
    if constexpr (kTraced)
        if (probed(hit.light) || merged(hit.light) || covered([&] { return LightTarget::met(hit, path_.time); }))
            return;
    const float weight = foundWeight(lightPdf, [&] {
        const double e =
            context_.traced->emission.density(hit.light, hit.light->partOf(hit), hit.p, hit.ng, -direction, path_.time)
                .total();
        return e / static_cast<double>(std::abs(dot(direction, hit.ng)));
    });
    gather(path_.beta * weight * emitted, hit.light, false, [&] { observer_->meets(hit.light, emitted, lightPdf); });
}

template <EffectBits E> void PathLoop<E>::leaveScene(const Ray& ray) {
    const Vec3 direction = ray.direction;
    if (observer_) [[unlikely]]
        observer_->leaves(direction);
    checkDirection(direction);
    if (context_.scene.hidden.splits && !arrivesAlike(ray, kInfinity)) [[unlikely]]
        return;
    for (const DistantLight* light : context_.lights.infinite()) {
        if (!light->visible().has(ray.kind)) continue;
        float lightPdf = 0;
        if (!path_.delta && context_.how.asksLights)
            lightPdf = context_.lights.probability(light, 0, path_.from, path_.scatters) *
                       light->pdfEscaped(path_.from, direction, path_.time);
        checkDensities(lightPdf, path_.bsdfPdf);
        const Spectrum arriving = light->escaped(direction, path_.lambda, path_.time);
        if constexpr (kTraced)
            if (probed(light) || merged(light) ||
                covered([&] { return LightTarget::met(*light, direction, path_.time); }))
                continue;
        const float weight = foundWeight(lightPdf, [&] {
            return context_.traced->emission.density(light, path_.from.p, -direction, path_.time).total();
        });
        gather(path_.beta * weight * arriving, light, false, [&] { observer_->meets(light, arriving, lightPdf); });
    }
}

template <EffectBits E>
void PathLoop<E>::sampleLight(const SurfaceHit& hit, const Bsdf& bsdf, const Directions& eye,
                              const VertexSample& sample, [[maybe_unused]] std::uint32_t depth) {
    if (!context_.how.asksLights || context_.lights.empty()) return;
    if (!bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy)) return; // delta lobes meet no sampled direction
    const PickedLight picked = context_.lights.pick(sample.pick, path_.from, path_.scatters);
    auto light = picked.light->sample(path_.from, picked.part, sample.light, path_.lambda, path_.time);
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
    hideFromScattering(*light, *picked.light, origin);
    const float pdf = picked.probability * light->pdfSolidAngle;
    checkDensities(pdf, eval.pdfSolidAngle);
    if constexpr (kDispersion) checkRatios(eval.pdfRatio);
    const float weight = askedWeight(*light, picked, eval, eye.woRender);
    Spectrum contribution = path_.beta * eval.fcos * light->radiance * (weight / pdf);
    if constexpr (kInterfaces) {
        contribution *= passing;
    } else if constexpr (kAbsorption) {
        const Curve* medium = through ? absorptionBeyond(hit, light->wi) : path_.interior.absorption;
        if (medium && light->distance < kInfinity) contribution *= exp(medium->at(path_.lambda) * -light->distance);
    }
    gather(contribution, picked.light, false, [&] { observer_->asks(picked.light, *light, eval, pdf); });
}

} // namespace abbe
