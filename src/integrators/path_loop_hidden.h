// The part of the path loop for shapes that shadow rays see and scattered ones do not, or the other way round. Included
// by path_loop.h.
//
// Light arrives directly where shadow rays reach its source, whichever way it is found:
//
//   * What scattering meets counts only if no shape stands between that shadow rays alone see.
//   * What is asked for is weighed against scattering only where that could have met it: if the source is visible to
//     scattered rays, and no shape stands between that they alone see. Otherwise its weight is 1, as a point's.
//
// So the weights of both sum to 1 wherever shadow rays see the source, and to 0 elsewhere. Mirrors and clear glass show
// what scattered rays meet, as nothing is asked for there. Shapes with openings, boundaries and dielectrics are seen by
// both kinds alike (SceneBuilder::checkVisible): what stands between is solid.
#pragma once

namespace abbe {

// How far a ray of this kind goes before it meets anything solid; at least tMax if it meets nothing.
template <EffectBits E> float PathLoop<E>::clearWay(Vec3 origin, Vec3 direction, float tMax, RayKind kind) const {
    Ray ray{origin, direction, tMax, path_.time, kind};
    SurfaceHit hit;
    float gone = 0;
    for (std::uint32_t crossings = 0; crossings < kMaxVertices; ++crossings) {
        if (!context_.scene.intersector->intersect(ray, hit)) return tMax;
        const Material& material = *hit.material;
        gone += hit.distance;
        if (!material.isBoundary() && !material.mayBeOpen() && !material.ior()) return gone;
        ray.origin = spawnOrigin(hit, direction);
        ray.tMax = tMax - gone;
        if (!(ray.tMax > 0)) return tMax;
    }
    return tMax;
}

// Whether shadow rays from the last vertex reach the emitter that scattering has met there.
template <EffectBits E> bool PathLoop<E>::arrivesAlike(const SurfaceHit& hit, Vec3 direction) const {
    if (path_.delta) return true;
    const float rounding = 0x1p-21f * length(hit.p - path_.origin);
    const Vec3 end = spawnOrigin(hit.p, hit.pError + Vec3{rounding, rounding, rounding}, hit.ng, -direction);
    const Vec3 way = end - path_.origin;
    const float distance = length(way);
    if (!(distance > 0)) return true;
    return clearWay(path_.origin, way * (1 / distance), distance, RayKind::shadow) >= distance;
}

// The same for light from a place on the ray, or from its end.
template <EffectBits E> bool PathLoop<E>::arrivesAlike(const Ray& ray, float t) const {
    if (path_.delta) return true;
    const float before = length(ray.origin - path_.origin);
    return clearWay(path_.origin, ray.direction, before + t, RayKind::shadow) >= before + t;
}

// Marks what scattering from there cannot meet.
template <EffectBits E>
void PathLoop<E>::hideFromScattering(LightSample& light, const Light& source, Vec3 origin) const {
    if (!source.visible().has(RayKind::scattered)) light.delta = true;
    if (!context_.scene.hidden.splits || light.delta) [[likely]]
        return;
    const Vec3 way = light.p - origin;
    const float distance = light.distance < kInfinity ? length(way) : kInfinity;
    const Vec3 direction = light.distance < kInfinity ? way * (1 / distance) : light.wi;
    light.delta = distance > 0 && clearWay(origin, direction, distance, RayKind::scattered) < distance;
}

} // namespace abbe
