#include "textures/placed_texture.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace abbe {

namespace {

// The half axes, longer one first, of the ellipse { cos t · a + sin t · b }: a and b are conjugate half diameters, and
// at tan 2t = 2 a·b / (|a|² - |b|²) they stand at right angles.
std::pair<Vec2, Vec2> halfAxes(Vec2 a, Vec2 b) {
    const auto dot2 = [](Vec2 v, Vec2 w) { return v.x * w.x + v.y * w.y; };
    const float t = 0.5f * std::atan2(2 * dot2(a, b), dot2(a, a) - dot2(b, b)), c = std::cos(t), s = std::sin(t);
    const Vec2 first = a * c + b * s, second = b * c - a * s;
    return dot2(first, first) >= dot2(second, second) ? std::pair(first, second) : std::pair(second, first);
}

} // namespace

PlacedTexture::PlacedTexture(const PlacedTextureParams& p)
    : map_(p.map, 0.5f), a_{std::cos(p.rotate) * p.scale.x, -std::sin(p.rotate) * p.scale.y},
      b_{std::sin(p.rotate) * p.scale.x, std::cos(p.rotate) * p.scale.y}, offset_(p.offset) {}

bool PlacedTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    map_.prepare(use, user, diagnostics);
    return true;
}

TextureQuery PlacedTexture::placed(TextureQuery q) const {
    q.uv = placed(q.uv);
    std::tie(q.du, q.dv) = halfAxes(turned(q.du), turned(q.dv));
    return q;
}

TextureJet PlacedTexture::jet(const TexturePoint& point, int channels) const noexcept {
    TexturePoint there = point;
    there.uv = placed(point.uv);
    there.home = placed(point.home);
    TextureJet j = map_.jet(there, channels);
    const std::array<Vec3, 2> by = j.byUv;
    const auto sum = [&](double u, double v) { return by[0] * static_cast<float>(u) + by[1] * static_cast<float>(v); };
    j.byUv = {sum(a_.x, b_.x), sum(a_.y, b_.y)}; // the chain rule: by the transpose
    return j;
}

schema::TypeInfo placedTextureType() {
    using namespace schema;
    using P = PlacedTextureParams;
    return {
        Kind::texture,
        "placed",
        "A texture with other texture coordinates than the shape's: scaled, then turned, then moved.",
        "texture bricks placed { map image \"bricks.png\"; scale 4 2 }",
        false,
        {
            field<P, TexturedSpectrum>(FieldType::spectrum, "map", &P::map)
                .role(SpectrumRole::albedo)
                .range(0, 1)
                .required()
                .synonyms({"texture", "image", "input"})
                .doc("What is placed.")
                .example("map image \"bricks.png\""),
            field<P, Vec2d>(FieldType::vector2, "scale", &P::scale)
                .byDefault("1 1")
                .synonyms({"repeat", "tiling", "tile"})
                .doc("How often it is repeated across one unit of u and of v; negative numbers mirror it.")
                .example("scale 4 2"),
            field<P, double>(FieldType::quantity, "rotate", &P::rotate)
                .unit({Dimension::angle})
                .byDefault("0 deg")
                .synonyms({"rotation", "angle"})
                .doc("Turns the scaled coordinates counter-clockwise about the origin, and so the picture clockwise.")
                .example("rotate 30 deg"),
            field<P, Vec2d>(FieldType::vector2, "offset", &P::offset)
                .byDefault("0 0")
                .synonyms({"translate", "shift"})
                .doc("Added to the coordinates at last.")
                .example("offset 0.5 0"),
        }};
}

} // namespace abbe
