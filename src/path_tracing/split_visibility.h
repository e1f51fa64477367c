// Shapes that shadow rays see and scattered ones do not, or the other way round.
//
// Light arrives directly where shadow rays reach its source, whichever way it is found:
//
//   * What scattering hits counts only if no shape stands between that shadow rays alone see.
//   * What next-event estimation finds is weighed against scattering only where that could have hit it: if the source
//     is visible to scattered rays, and no shape stands between that they alone see. Otherwise its weight is 1, as a
//     point's.
//
// So the weights of both sum to 1 wherever shadow rays see the source, and to 0 elsewhere. Mirrors and clear glass show
// what scattered rays hit, as they have no next-event estimation. Shapes with openings, boundaries and dielectrics are
// seen by both kinds alike (Placer::noteVisible): what stands between is solid.
#pragma once

#include "transport/walk.h"

namespace abbe {

// How far a ray of this kind goes before it hits anything solid; at least tMax if it hits nothing.
template <EffectBits E> float clearWay(const PathWalk<E>& walk, Vec3 origin, Vec3 direction, float tMax, RayKind kind) {
    Ray ray{origin, direction, tMax, walk.path.time, kind};
    SurfaceHit hit;
    float gone = 0;
    for (std::uint32_t crossings = 0; crossings < PathWalk<E>::kMaxVertices; ++crossings) {
        if (!walk.context.scene.intersector->intersect(ray, hit)) return tMax;
        const Material& material = *hit.material;
        gone += hit.distance;
        if (!material.isBoundary() && !material.mayBeOpen() && !material.ior()) return gone;
        ray.origin = spawnOrigin(hit, direction);
        ray.tMax = tMax - gone;
        if (!(ray.tMax > 0)) return tMax;
    }
    return tMax;
}

// Whether shadow rays from `origin`, where the path's last ray started, reach the emitter that it has hit.
template <EffectBits E>
bool reachedByShadowRays(const PathWalk<E>& walk, Vec3 origin, const SurfaceHit& hit, Vec3 direction) {
    if (walk.path.delta) return true;
    const float rounding = 0x1p-21f * length(hit.p - origin);
    const Vec3 end = spawnOrigin(hit.p, hit.pError + Vec3{rounding, rounding, rounding}, hit.ng, -direction);
    const Vec3 way = end - origin;
    const float distance = length(way);
    if (!(distance > 0)) return true;
    return clearWay(walk, origin, way * (1 / distance), distance, RayKind::shadow) >= distance;
}

// The same for light from a place on the ray, or from its end.
template <EffectBits E> bool reachedByShadowRays(const PathWalk<E>& walk, Vec3 origin, const Ray& ray, float t) {
    if (walk.path.delta) return true;
    const float before = length(ray.origin - origin);
    return clearWay(walk, origin, ray.direction, before + t, RayKind::shadow) >= before + t;
}

// Marks what scattering from there cannot hit.
template <EffectBits E>
void hideFromScattering(const PathWalk<E>& walk, LightSample& light, const Light& source, Vec3 origin) {
    if (!source.visible().has(RayKind::scattered)) light.delta = true;
    if (!walk.context.scene.hidden.splits || light.delta) [[likely]]
        return;
    const Vec3 way = light.p - origin;
    const float distance = light.distance < kInfinity ? length(way) : kInfinity;
    const Vec3 direction = light.distance < kInfinity ? way * (1 / distance) : light.wi;
    light.delta = distance > 0 && clearWay(walk, origin, direction, distance, RayKind::scattered) < distance;
}

} // namespace abbe
