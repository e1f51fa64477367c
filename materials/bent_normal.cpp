#include "materials/bent_normal.h"

#include "render/surface_input.h"

namespace abbe {

Vec3 mappedNormal(const NormalMap& map, const SurfaceHit& hit) {
    const TextureWork work;
    const Vec3 n = hit.shading.z, stored = map.texture->value(TextureQuery(hit));
    const Vec3 along = hit.dpdu - n * dot(n, hit.dpdu);
    const float l2 = lengthSquared(along);
    if (!(l2 > 1e-12f * lengthSquared(hit.dpdu))) return n;
    const Vec3 t = along * (1 / std::sqrt(l2)), across = cross(n, t);
    const Vec3 b = dot(across, hit.dpdv) < 0 ? -across : across; // mirrored texture coordinates
    const float x = (2 * stored.x - 1) * map.strength, y = (2 * stored.y - 1) * map.strength;
    const Vec3 bent = t * x + b * y + n * std::max(2 * stored.z - 1, 1e-3f);
    const float length2 = lengthSquared(bent);
    return length2 > 0 && length2 < kInfinity ? bent * (1 / std::sqrt(length2)) : n;
}

} // namespace abbe
