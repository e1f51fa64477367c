// Where light paths start.
#pragma once

#include "caustics/shared/aimed_emission.h"
#include "render/scene.h"
#include "transport/sampler.h"
#include "transport/surroundings.h"

#include <algorithm>

namespace abbe {

// By vertex 0 of the sampler. Nothing where no light leaves.
inline std::optional<EmittedRay> startOfLightPath(const AimedEmission& emission, Sampler& sampler,
                                                  const Wavelengths& lambda, float time) {
    const VertexSample n = sampler.vertex(0);
    const EmissionNumbers numbers{static_cast<double>(n.pick), static_cast<double>(sampler.film().x), n.lobe, n.light,
                                  n.bsdf};
    return emission.sample(numbers, lambda, time);
}

// What has no end may lie before the place where light from far away starts.
inline bool isShaded(const Scene& scene, const EmittedRay& start) {
    if (!start.density.distant) return false;
    return scene.intersector->occluded({start.ray.origin, -start.ray.direction, kInfinity, start.ray.time});
}

inline Surroundings surroundingsOf(const Scene& scene, const EmittedRay& start) {
    const auto contains = [&](const Bounds3& filled) { return filled.contains(start.ray.origin); };
    if (!std::ranges::any_of(scene.filled, contains)) return {};
    return surroundingsAt(scene, start.ray.origin, start.ray.time);
}

} // namespace abbe
