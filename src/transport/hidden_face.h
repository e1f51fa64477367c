// Faces of dielectrics that separate nothing, because they lie within others [Schmidt2002].
#pragma once

#include "render/scene.h"
#include "transport/surroundings.h"

#include <array>

namespace abbe {

// Whether the surface of a dielectric, met along the ray from `here`, separates nothing: the same dielectric fills the
// space on both sides. `beyond` becomes what lies behind it, and hit.outside is set. Faces of several shapes that
// coincide are met as one: `hit` becomes the face of the dielectric that is entered or, if none is, left.
inline bool isHiddenFace(const Scene& scene, SurfaceHit& hit, const Ray& ray, const Surroundings& here,
                         Surroundings& beyond) {
    const Material* const before = here.filling();
    const bool known = dot(ray.direction, hit.ng) < 0 || here.contains(hit.material);
    beyond = here;
    beyond.cross(hit, ray.direction);
    std::array<SurfaceHit, 4> others;
    std::size_t count = 0;
    if (scene.nested) {
        count = scene.intersector->coincident(ray, hit, others);
        for (std::size_t i = 0; i < count; ++i) beyond.cross(others[i], ray.direction);
        leaveBeyond(hit, std::span(others).first(count));
    }
    const Material* const after = beyond.filling();
    // A dielectric that is left without having been entered, as through a hole, is taken to have been there.
    if (before == after && !known && (!before || hit.material->priority() >= before->priority())) {
        hit.outside = here.ior();
        return false;
    }
    if (before == after) return true;
    const auto takeFaceOf = [&, offset = hit.pError](const Material* material) {
        for (std::size_t i = 0; i < count && hit.material != material; ++i)
            if (others[i].material == material) hit = others[i];
        hit.pError = offset;
        return hit.material == material;
    };
    if (!after || !takeFaceOf(after)) takeFaceOf(before);
    hit.outside = hit.material == after ? here.ior() : beyond.ior();
    return false;
}

} // namespace abbe
