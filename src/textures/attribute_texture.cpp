#include "textures/attribute_texture.h"

#include "base/diagnostic.h"
#include "render/shape.h"
#include "render/surface_hit.h"
#include "spectrum/upsampling_table.h"

namespace abbe {

AttributeTexture::AttributeTexture(const AttributeTextureParams& p)
    : name_(p.name.value), encoded_(p.encoding.word == "srgb") {}
AttributeTexture::~AttributeTexture() = default;

const RgbSpace* AttributeTexture::rgbSpace() const { return &rgb::rec709; }

bool AttributeTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    if ((use == TextureUse::reflectance || use == TextureUse::light) && !table_)
        table_ = std::make_unique<const UpsamplingTable>(UpsamplingTable::loadOrBuild(rgb::rec709));
    if (use != TextureUse::heights) return true;
    diagnostics.error("E0736", user, "`attribute` cannot be heights", "has values at vertices only").help =
        "displace by `noise`, or by an image over texture coordinates";
    return false;
}

Vec3 AttributeTexture::value(const TextureQuery& query) const noexcept {
    if (!query.hit || !query.hit->shape) return {};
    const VertexAttributes* const attributes = query.hit->shape->attributes();
    if (!attributes) return {};
    Vec3 v = attributes->attribute(name_, *query.hit).value_or(Vec3{});
    if (encoded_)
        v = {static_cast<float>(srgbToLinear(static_cast<double>(v.x))),
             static_cast<float>(srgbToLinear(static_cast<double>(v.y))),
             static_cast<float>(srgbToLinear(static_cast<double>(v.z)))};
    return v;
}

Spectrum AttributeTexture::spectrum(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    const Vec3 v = value(query);
    return table_ ? table_->lookup(v).at(lambda) : Spectrum(std::clamp(v.x, 0.f, 1.f));
}

Spectrum AttributeTexture::lightFactor(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    return table_ ? table_->unbounded(value(query), lambda) : Texture::lightFactor(query, lambda);
}

schema::TypeInfo attributeTextureType() {
    using namespace schema;
    using P = AttributeTextureParams;
    return {Kind::texture,
            "attribute",
            "Values at the vertices of a mesh, by name: the properties of a PLY file.",
            "texture painted attribute \"color\" { encoding srgb }",
            false,
            {
                field<P, Text>(FieldType::text, "name", &P::name)
                    .argument(0)
                    .required()
                    .synonyms({"attribute", "property", "primvar"})
                    .doc("Its name; `color` is red, green and blue together.")
                    .example("name \"color\""),
                field<P, Choice>(FieldType::choice, "encoding", &P::encoding)
                    .choices({"linear", "srgb"})
                    .byDefault("linear")
                    .synonyms({"space", "colorspace"})
                    .doc("How colours are stored; scans with 8 bits usually are `srgb`.")
                    .example("encoding srgb"),
            }};
}

} // namespace abbe
