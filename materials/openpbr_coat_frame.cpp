#include "materials/openpbr_coat_frame.h"

#include "materials/normal_map.h"
#include "math/consistent_normal.h"
#include "render/texture_work.h"

namespace abbe {

OpenPbrCoatFrame::OpenPbrCoatFrame(const OpenPbrParams& p)
    : normal_(p.geometryCoatNormal), tangent_(p.geometryCoatTangent) {}

// What the material wears has bent the hit's normal; the shape's own is known in its space.
Vec3 OpenPbrCoatFrame::normal(const SurfaceHit& hit) const {
    if (!ownNormal()) return hit.shading.z;
    const Vec3 l = hit.localNormal, own = hit.localX * l.x + hit.localY * l.y + hit.localZ * l.z;
    const float l2 = lengthSquared(own);
    if (!(l2 > 0)) return hit.shading.z;
    SurfaceHit plain = hit;
    plain.shading.z = own * ((dot(own, hit.ng) < 0 ? -1 : 1) / std::sqrt(l2));
    const auto follow = static_cast<float>(normal_.value);
    const Vec3 n = normal_.texture ? mappedNormal({normal_.texture, 1}, plain)
                                   : normalize(plain.shading.z * (1 - follow) + hit.shading.z * follow);
    return consistentNormal(hit.ng, n, -hit.arrival);
}

Vec3 OpenPbrCoatFrame::tangent(const SurfaceHit& hit, Vec3 n) const {
    const bool known = lengthSquared(hit.dpdu) > 0;
    const Frame along = Frame::fromNormalTangent(n, known ? hit.dpdu : hit.shading.x);
    const float side = known && dot(along.y, hit.dpdv) < 0 ? -1.f : 1.f; // mirrored texture coordinates
    if (!tangent_.texture) {
        const float angle = 2 * kPi * static_cast<float>(tangent_.value);
        return along.x * std::cos(angle) + along.y * (side * std::sin(angle));
    }
    const TextureWork work;
    const Vec3 stored = tangent_.texture->value(TextureQuery(hit));
    return along.x * (2 * stored.x - 1) + along.y * (side * (2 * stored.y - 1));
}

std::optional<Frame> OpenPbrCoatFrame::at(const SurfaceHit& hit) const {
    if (!usesTextures()) return std::nullopt;
    const Vec3 n = normal(hit);
    const Frame own = Frame::fromNormalTangent(n, tangent(hit, n)), &base = hit.shading;
    return Frame{base.toLocal(own.x), base.toLocal(own.y), base.toLocal(own.z)};
}

} // namespace abbe
