// From a hit to what textures are asked.
#pragma once

#include "render/surface_hit.h"
#include "render/texture.h"

namespace abbe {

// The cone of the path meets the tangent plane in an ellipse; its half axes in uv follow from dp/du and dp/dv by least
// squares [Igehy1999, sec. 3.2; Pharr2023, eq. 10.5].
inline TextureQuery::TextureQuery(const SurfaceHit& h)
    : uv(h.uv), position(h.local), normal(h.localNormal), radius(h.footprint * h.localScale), hit(&h) {
    if (!(h.footprint > 0)) return;
    const float uu = dot(h.dpdu, h.dpdu), uw = dot(h.dpdu, h.dpdv), ww = dot(h.dpdv, h.dpdv);
    const float determinant = uu * ww - uw * uw;
    if (!(determinant > 1e-12f * uu * ww)) return; // no texture coordinates, or degenerate ones
    const float cosine = std::abs(dot(h.arrival, h.ng));
    Vec3 along = h.arrival - h.ng * dot(h.arrival, h.ng);
    const float sine = length(along);
    along = sine > 1e-4f ? along * (1 / sine) : h.shading.x;
    const Vec3 across = cross(h.ng, along);
    const Vec3 major = along * (h.footprint / std::max(cosine, 0.01f)), minor = across * h.footprint;
    const auto inUv = [&](Vec3 d) {
        const float a = dot(h.dpdu, d), b = dot(h.dpdv, d);
        return Vec2{(ww * a - uw * b) / determinant, (uu * b - uw * a) / determinant};
    };
    du = inUv(major);
    dv = inUv(minor);
}

} // namespace abbe
