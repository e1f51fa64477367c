#include "textures/product_texture.h"

namespace abbe {

bool ProductTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    first_.prepare(use, user, diagnostics);
    second_.prepare(use, user, diagnostics);
    return true;
}

TextureJet ProductTexture::jet(const TexturePoint& point, int channels) const noexcept {
    const TextureJet a = first_.jet(point, channels), b = second_.jet(point, channels);
    TextureJet j;
    j.value = multiply(a.value, b.value);
    for (std::size_t i = 0; i < 3; ++i)
        j.byPosition[i] = multiply(a.byPosition[i], b.value) + multiply(a.value, b.byPosition[i]);
    for (std::size_t i = 0; i < 2; ++i) j.byUv[i] = multiply(a.byUv[i], b.value) + multiply(a.value, b.byUv[i]);
    return j;
}

schema::TypeInfo productTextureType() {
    using namespace schema;
    using P = ProductTextureParams;
    const auto part = [](std::string_view name, TexturedSpectrum P::*member, std::string_view example) {
        return field<P, TexturedSpectrum>(FieldType::spectrum, name, member)
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .required()
            .doc("One of the two factors.")
            .example(example);
    };
    return {Kind::texture,
            "product",
            "Two textures, or a texture and a spectrum, multiplied.",
            "texture aged product { first checker; second noise { scale 20 cm } }",
            false,
            {part("first", &P::first, "first checker"), part("second", &P::second, "second noise { scale 20 cm }")}};
}

} // namespace abbe
