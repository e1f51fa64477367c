#include "textures/checker_texture.h"

#include <cmath>

namespace abbe {

// By the integral of the square wave, which grows by 1 in every odd interval [Pharr2023, sec. 10.4].
double oddShare(double x, double half) {
    if (!std::isfinite(x) || !(half < 1e6)) return 0.5;
    if (!(half > 1e-9 * std::max(1.0, std::abs(x)))) {
        const double turn = 0.5 * x;
        return turn - std::floor(turn) >= 0.5;
    }
    const auto integral = [](double t) {
        const double pairs = std::floor(0.5 * t);
        return pairs + std::max(0.0, t - 2 * pairs - 1);
    };
    return std::clamp((integral(x + half) - integral(x - half)) / (2 * half), 0.0, 1.0);
}

CheckerTexture::CheckerTexture(const CheckerTextureParams& p)
    : even_(p.even, 0.8f), odd_(p.odd, 0.2f), solid_(p.scale.dimension == schema::Dimension::length),
      frequency_(solid_ ? 1 / p.scale.value : p.scale.value) {}

bool CheckerTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    even_.prepare(use, user, diagnostics);
    odd_.prepare(use, user, diagnostics);
    return true;
}

// A check is odd if an odd number of its coordinates are. In a box these are independent, and with the shares a, b, …
// 1 - 2 P(odd) = (1 - 2 a)(1 - 2 b) ….
double CheckerTexture::oddShare(const TextureQuery& q) const {
    const auto balance = [this](float x, double half) {
        return 1 - 2 * abbe::oddShare(static_cast<double>(x) * frequency_, half * frequency_);
    };
    if (!solid_)
        return 0.5 -
               0.5 * balance(q.uv.x, boxHalfWidth(q.du.x, q.dv.x)) * balance(q.uv.y, boxHalfWidth(q.du.y, q.dv.y));
    return 0.5 - 0.5 * balance(q.position.x, boxHalfWidth(q, q.normal.x)) *
                     balance(q.position.y, boxHalfWidth(q, q.normal.y)) *
                     balance(q.position.z, boxHalfWidth(q, q.normal.z));
}

TextureJet CheckerTexture::jet(const TexturePoint& point, int channels) const noexcept {
    const TextureQuery query(point.uv, Vec3(point.position));
    return (oddShare(query) > 0.5 ? odd_ : even_).jet(point, channels);
}

Vec3 CheckerTexture::value(const TextureQuery& query) const noexcept {
    const auto odd = static_cast<float>(oddShare(query));
    if (odd <= 0) return even_.value(query);
    if (odd >= 1) return odd_.value(query);
    return even_.value(query) * (1 - odd) + odd_.value(query) * odd;
}

Spectrum CheckerTexture::spectrum(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    const auto odd = static_cast<float>(oddShare(query));
    if (odd <= 0) return even_.spectrum(query, lambda);
    if (odd >= 1) return odd_.spectrum(query, lambda);
    return even_.spectrum(query, lambda) * (1 - odd) + odd_.spectrum(query, lambda) * odd;
}

Spectrum CheckerTexture::lightFactor(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    const auto odd = static_cast<float>(oddShare(query));
    if (odd <= 0) return even_.lightFactor(query, lambda);
    if (odd >= 1) return odd_.lightFactor(query, lambda);
    return even_.lightFactor(query, lambda) * (1 - odd) + odd_.lightFactor(query, lambda) * odd;
}

schema::TypeInfo checkerTextureType() {
    using namespace schema;
    using P = CheckerTextureParams;
    return {Kind::texture,
            "checker",
            "Two values in squares over the texture coordinates, or in cubes in the space of the shape.",
            "texture floor checker { even 0.8; odd rgb 0.1 0.2 0.4; scale 12 }",
            false,
            {
                field<P, TexturedSpectrum>(FieldType::spectrum, "even", &P::even)
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .synonyms({"tex1", "color1", "light"})
                    .doc("Of the squares at the origin; 0.8 when absent.")
                    .example("even 0.8"),
                field<P, TexturedSpectrum>(FieldType::spectrum, "odd", &P::odd)
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .synonyms({"tex2", "color2", "dark"})
                    .doc("Of the others; 0.2 when absent.")
                    .example("odd rgb 0.1 0.2 0.4"),
                field<P, Quantity>(FieldType::quantity, "scale", &P::scale)
                    .unit({Dimension::none, Dimension::length})
                    .range(1e-9, 1e9)
                    .byDefault("8")
                    .synonyms({"frequency", "repeat", "size"})
                    .doc("How many squares across one unit of the texture coordinates; with a unit, the edge of cubes.")
                    .example("scale 10 cm"),
            }};
}

} // namespace abbe
