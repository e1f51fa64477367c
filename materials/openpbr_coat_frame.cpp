#include "materials/openpbr_coat_frame.h"

#include "materials/normal_map.h"
#include "materials/openpbr_tangent.h"
#include "math/frame.h"

namespace abbe {

OpenPbrCoatFrame::OpenPbrCoatFrame(const OpenPbrParams& p)
    : normal_(p.geometryCoatNormal), tangent_(p.geometryCoatTangent), baseTurned_(turnsTangent(p)) {}

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

std::optional<Frame> OpenPbrCoatFrame::at(const SurfaceHit& hit) const {
    if (!usesTextures()) return std::nullopt;
    const Vec3 n = normal(hit);
    const Frame own = Frame::fromNormalTangent(n, openPbrTangent(tangent_, hit, n)), &base = hit.shading;
    return Frame{base.toLocal(own.x), base.toLocal(own.y), base.toLocal(own.z)};
}

} // namespace abbe
