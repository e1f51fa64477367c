#include "textures/triplanar_texture.h"

#include <cmath>

namespace abbe {

TriplanarTexture::TriplanarTexture(const TriplanarTextureParams& p)
    : map_(p.map, 0.5f), frequency_(static_cast<float>(1 / p.scale)), sharpness_(static_cast<float>(p.sharpness)) {}

bool TriplanarTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    map_.prepare(use, user, diagnostics);
    if (use != TextureUse::heights) return true;
    diagnostics.error("E0736", user, "`triplanar` cannot be heights", "follows the normal, which heights turn").help =
        "displace by `noise`, or by an image over texture coordinates";
    return false;
}

// Calls add(query, weight) for the projections that count; weights sum to 1.
template <typename Add> void TriplanarTexture::project(const TextureQuery& q, Add add) const {
    const auto power = [this](float n) { return std::pow(std::abs(n), sharpness_); };
    Vec3 w{power(q.normal.x), power(q.normal.y), power(q.normal.z)};
    const float sum = w.x + w.y + w.z;
    w = sum > 0 && std::isfinite(sum) ? w * (1 / sum) : Vec3(0, 1, 0);
    TextureQuery side = q;
    const float radius = q.radius * frequency_;
    side.du = {radius, 0};
    side.dv = {0, radius};
    const Vec3 p = q.position * frequency_;
    const auto seen = [&](Vec2 uv, float weight) {
        if (!(weight > 1e-3f)) return; // not seen; what remains is made up for below
        side.uv = uv;
        add(side, weight);
    };
    const float kept = (w.x > 1e-3f ? w.x : 0) + (w.y > 1e-3f ? w.y : 0) + (w.z > 1e-3f ? w.z : 0);
    w = w * (1 / kept);
    seen({q.normal.x < 0 ? p.z : -p.z, p.y}, w.x);
    seen({p.x, q.normal.y < 0 ? p.z : -p.z}, w.y);
    seen({q.normal.z < 0 ? -p.x : p.x, p.y}, w.z);
}

TextureJet TriplanarTexture::jet(const TexturePoint& point, int) const noexcept {
    TextureQuery query(point.uv, Vec3(point.position));
    query.normal = {1, 1, 1};
    TextureJet j;
    j.value = value(query);
    return j;
}

Vec3 TriplanarTexture::value(const TextureQuery& query) const noexcept {
    Vec3 sum;
    project(query, [&](const TextureQuery& q, float weight) { sum += map_.value(q) * weight; });
    return sum;
}

Spectrum TriplanarTexture::spectrum(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    Spectrum sum(0.f);
    project(query, [&](const TextureQuery& q, float weight) { sum = sum + map_.spectrum(q, lambda) * weight; });
    return sum;
}

Spectrum TriplanarTexture::lightFactor(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    Spectrum sum(0.f);
    project(query, [&](const TextureQuery& q, float weight) { sum += map_.lightFactor(q, lambda) * weight; });
    return sum;
}

schema::TypeInfo triplanarTextureType() {
    using namespace schema;
    using P = TriplanarTextureParams;
    return {
        Kind::texture,
        "triplanar",
        "A texture over uv, projected along the three axes of the shape and blended: no texture coordinates needed.",
        "texture cast triplanar { map checker { scale 4 }; scale 0.5 m }",
        false,
        {
            field<P, TexturedSpectrum>(FieldType::spectrum, "map", &P::map)
                .role(SpectrumRole::albedo)
                .range(0, 1)
                .required()
                .synonyms({"texture", "image", "input"})
                .doc("What is projected.")
                .example("map checker { scale 4 }"),
            field<P, double>(FieldType::quantity, "scale", &P::scale)
                .unit({Dimension::length})
                .range(1e-9, 1e9)
                .byDefault("1 m")
                .synonyms({"size", "tile"})
                .doc("Length that one unit of its texture coordinates covers.")
                .example("scale 0.5 m"),
            field<P, double>(FieldType::number, "sharpness", &P::sharpness)
                .range(1, 64)
                .byDefault("4")
                .synonyms({"blend", "power"})
                .doc("How narrow the blend between two projections is: weights are powers of the normal.")
                .example("sharpness 8"),
        }};
}

} // namespace abbe
