#include "scene/wrapped_materials.h"

#include "math/frame.h"
#include "render/texture_work.h"

namespace abbe {

namespace {

// For Bsdfs that tell directions about the normal apart, x stays along the texture's u.
void turn(SurfaceHit& hit, Vec3 normal) {
    const bool known = lengthSquared(hit.dpdu) > 0;
    hit.shading = Frame::fromNormalTangent(normal, known ? hit.dpdu : hit.shading.x);
}

} // namespace

// n' ∝ n - ∇h, with the gradient of the height along the surface [Mikkelsen2010, eq. 3; Blinn1978]: by uv with the
// vectors dual to dp/du and dp/dv, by position with the gradients of the local coordinates.
Vec3 bumpedNormal(const BumpMap& map, const SurfaceHit& hit) {
    const TextureWork work;
    const Vec3 n = hit.shading.z;
    const TextureJet j = map.texture->jet({Vec3d(hit.local), hit.uv, hit.uv}, 1);
    Vec3 gradient = hit.localX * j.byPosition[0].x + hit.localY * j.byPosition[1].x + hit.localZ * j.byPosition[2].x;
    const Vec3 dual = cross(hit.dpdv, n);
    const float area = dot(hit.dpdu, dual);
    if (square(area) > 1e-12f * lengthSquared(hit.dpdu) * lengthSquared(hit.dpdv))
        gradient = gradient + (dual * j.byUv[0].x + cross(n, hit.dpdu) * j.byUv[1].x) * (1 / area);
    const Vec3 bent = n - (gradient - n * dot(n, gradient)) * map.height;
    const float l2 = lengthSquared(bent);
    return l2 < kInfinity ? bent * (1 / std::sqrt(l2)) : n;
}

Effects ModifiedMaterial::needs() const {
    Effects effects = inner_.needs();
    if (mayBeOpen() || modifiers_.priority != 0) effects |= Effect::interfaces;
    if (modifiers_.normal.texture || modifiers_.bump.texture) effects |= Effect::bumps;
    return effects;
}

bool ModifiedMaterial::usesTextures() const {
    return modifiers_.opacity.textured() || modifiers_.normal.texture || modifiers_.bump.texture ||
           inner_.usesTextures();
}

void ModifiedMaterial::bend(SurfaceHit& hit) const noexcept {
    if (modifiers_.normal.texture) turn(hit, mappedNormal(modifiers_.normal, hit));
    if (modifiers_.bump.texture) turn(hit, bumpedNormal(modifiers_.bump, hit));
    if (modifiers_.normal.texture || modifiers_.bump.texture)
        turn(hit, consistentNormal(hit.ng, hit.shading.z, -hit.arrival));
    inner_.bend(hit); // which may turn the tangent
}

} // namespace abbe
