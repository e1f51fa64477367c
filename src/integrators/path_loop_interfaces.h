// The part of the path loop for what light passes without being scattered: boundaries of media, open surfaces, and
// faces of dielectrics that lie hidden inside others (hidden_face.h). Included by path_loop.h.
#pragma once

namespace abbe {

template <EffectBits E>
typename PathLoop<E>::Arrival PathLoop<E>::arrive(Ray& ray, SurfaceHit& hit, std::uint32_t depth) {
    if constexpr (kInterfaces) return arriveThrough(ray, hit, depth);
    if (!context_.scene.intersector->intersect(ray, hit)) return Arrival::nowhere;
    if constexpr (kAbsorption) absorb(hit, ray.direction, hit.distance);
    if constexpr (kTextures) path_.cone.advance(hit.distance);
    return Arrival::surface;
}

// The share of the light at a surface that goes straight on, which has then crossed it.
template <EffectBits E> float PathLoop<E>::straightOn(SurfaceHit& hit, const Ray& ray, path_detail::Nested& nested) {
    const Material& material = *hit.material;
    if (material.isBoundary()) {
        nested.here.cross(hit, ray.direction);
        return 1;
    }
    float open = 0;
    if (material.mayBeOpen()) {
        hit.arrival = ray.direction;
        if constexpr (kTextures) hit.footprint = path_.cone.radius;
        const float opacity = material.opacity(hit);
        open = 1 - opacity;
        if (!(opacity >= 0 && opacity <= 1)) condemn(opacity, {&material, "opacity"});
        if (open >= 1) return 1;
    }
    if (material.ior()) {
        if (!isHiddenFace(context_.scene, hit, ray, nested.here, nested.beyond)) return open;
        nested.here = nested.beyond;
        return 1;
    }
    hit.outside = nested.here.ior();
    nested.beyond = nested.here;
    nested.beyond.cross(hit, ray.direction);
    return open;
}

// Goes on to the next collision or to the next surface that does anything to the path.
template <EffectBits E>
typename PathLoop<E>::Arrival PathLoop<E>::arriveThrough(Ray& ray, SurfaceHit& hit, std::uint32_t depth) {
    RandomStream random = sampler_.stream(2 * depth);
    for (std::uint32_t crossings = 0; crossings < kMaxVertices; ++crossings) {
        const bool met = context_.scene.intersector->intersect(ray, hit);
        if constexpr (kMedia) {
            if (collides(ray, met ? &hit : nullptr, random, depth, crossings)) return Arrival::collision;
        } else if constexpr (kAbsorption) {
            if (met) absorb(hit, ray.direction, hit.distance);
        }
        if (!met) return Arrival::nowhere;
        if constexpr (kTextures) path_.cone.advance(hit.distance);
        const float share = straightOn(hit, ray, path_.nested);
        if (share < 1 && !(share > 0 && random.uniform() < share)) return Arrival::surface;
        ray.origin = spawnOrigin(hit, ray.direction);
        ++counters_.effects.crossings;
        if (toldToLeave(crossings)) return Arrival::nowhere;
    }
    cap(&hit);
    path_.beta = Spectrum(0.f);
    return Arrival::nowhere;
}

// Of a clear absorbing dielectric, over a distance.
template <EffectBits E> Spectrum PathLoop<E>::clearness(const Surroundings& inside, float distance) const {
    if constexpr (kAbsorption)
        if (const Curve* clear = inside.absorption(); clear && distance < kInfinity)
            return exp(clear->at(path_.lambda) * -distance);
    return Spectrum(1.f);
}

// Of everything between a vertex and a light: nothing behind a surface.
template <EffectBits E>
Spectrum PathLoop<E>::transmittance(Vec3 origin, const LightSample& light, path_detail::Nested nested,
                                    [[maybe_unused]] RandomStream random, RayKind kind) {
    const bool infinite = !(light.distance < kInfinity);
    // Up to tMax; `end` is the same, measured as without media, where they shall make no difference.
    const auto along = [&](const Ray& ray, const Surroundings& inside, float tMax, float end) {
        const Spectrum clear = clearness(inside, end);
        if constexpr (kMedia)
            return clear * media_.tracker.transmittance(ray, tMax, inside.media(), path_.lambda, random);
        return clear;
    };
    Ray ray{origin, light.wi, infinite ? kInfinity : length(light.p - origin), path_.time, kind};
    if (!context_.scene.boundaries) {
        if (occluded(origin, light, kind)) return Spectrum(0.f);
        return along(ray, nested.here, ray.tMax, light.distance);
    }
    Spectrum result(1.f);
    SurfaceHit hit;
    for (std::uint32_t crossings = 0; crossings < kMaxVertices; ++crossings) {
        // The direction is made anew: rounding would let long chains of boundaries miss the light's own point.
        if (!infinite) {
            const Vec3 way = light.p - ray.origin;
            ray.tMax = length(way);
            if (!(ray.tMax > 0)) return result;
            ray.direction = way / ray.tMax;
        }
        const bool met = context_.scene.intersector->intersect(ray, hit) && hit.distance < ray.tMax;
        if (!met) return result * along(ray, nested.here, ray.tMax, crossings == 0 ? light.distance : ray.tMax);
        const Surroundings before = nested.here;
        const float share = straightOn(hit, ray, nested);
        if (share == 0) return Spectrum(0.f);
        result *= along(ray, before, hit.distance, hit.distance) * share;
        if (!anyNonZero(result)) return result;
        ray.origin = spawnOrigin(hit, ray.direction);
        ++counters_.effects.shadowCrossings;
        if (toldToLeave(crossings)) return Spectrum(0.f);
    }
    cap(&hit);
    return Spectrum(0.f);
}

} // namespace abbe
