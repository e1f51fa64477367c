// The part of the path loop for the width of paths, over which textures are averaged. Included by path_loop.h.
#pragma once

namespace abbe {

// Mirrors and lenses widen or narrow the cone. `cosine`: that of the eye in the shading frame.
template <EffectBits E> void PathLoop<E>::turnCone(const SurfaceHit& hit, const BsdfSample& next, float cosine) {
    if (next.lobe.has(Lobe::diffuse)) return;
    // What stands in an instance has another scale: it counts as flat.
    const bool known = hit.shape && hit.instance == SurfaceHit::kNoInstance;
    const float bulge = known ? std::copysign(1.f, cosine) * hit.shape->meanCurvature(hit) : 0;
    if (next.lobe.has(Lobe::transmission))
        path_.cone.refract(bulge, next.eta, std::abs(cosine));
    else
        path_.cone.reflect(bulge, std::abs(cosine));
}

// The directions of a wide lobe lie far apart: each stands for a cone of about the solid angle 1/p. Only a part of that
// is averaged over, so that what a bounce sees keeps its texture (docs/language/textures.md, "Filtering").
template <EffectBits E> void PathLoop<E>::scatterCone() {
    constexpr float kShare = 0.15f;
    if (path_.delta) return;
    const float pdf = ownPdf_ > 0 ? ownPdf_ : path_.bsdfPdf; // what textures show must not depend on the technique
    path_.cone.spread = std::max(path_.cone.spread, kShare / std::sqrt(kPi * pdf));
}

} // namespace abbe
