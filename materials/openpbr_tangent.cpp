#include "materials/openpbr_tangent.h"

#include "math/frame.h"
#include "render/texture_query.h"
#include "render/texture_work.h"

namespace abbe {

Vec3 openPbrTangent(const schema::TexturedNumber& tangent, const SurfaceHit& hit, Vec3 n) {
    const bool known = lengthSquared(hit.dpdu) > 0;
    const Frame along = Frame::fromNormalTangent(n, known ? hit.dpdu : hit.shading.x);
    const float side = known && dot(along.y, hit.dpdv) < 0 ? -1.f : 1.f; // mirrored texture coordinates
    if (!tangent.texture) {
        const float angle = 2 * kPi * static_cast<float>(tangent.value);
        return along.x * std::cos(angle) + along.y * (side * std::sin(angle));
    }
    const TextureWork work;
    const Vec3 stored = tangent.texture->value(TextureQuery(hit));
    return along.x * (2 * stored.x - 1) + along.y * (side * (2 * stored.y - 1));
}

} // namespace abbe
