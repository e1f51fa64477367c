#include "textures/channel_texture.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace abbe {

Vec3 ChannelTexture::value(const TextureQuery& query) const noexcept {
    const float v = taken(of_.value(query));
    return {v, v, v};
}

TextureJet ChannelTexture::jet(const TexturePoint& point, int) const noexcept {
    const bool single = of_.channels() == 1;
    const TextureJet all = of_.jet(point, single ? 1 : 3);
    const auto one = [&](Vec3 v) { return Vec3{single ? v.x : taken(v), 0, 0}; };
    TextureJet j;
    j.value = one(all.value);
    std::ranges::transform(all.byPosition, j.byPosition.begin(), one);
    std::ranges::transform(all.byUv, j.byUv.begin(), one);
    return j;
}

std::unique_ptr<Texture> makeChannelTexture(const ChannelTextureParams& p, Diagnostics&) {
    if (!p.of.texture) return nullptr; // said already: it is required
    return std::make_unique<ChannelTexture>(*p.of.texture, p.take);
}

namespace {

constexpr std::array<std::string_view, 3> kChannelWords = {"red", "green", "blue"}; // as ColorChannel

} // namespace

schema::TypeInfo channelTextureType() {
    using namespace schema;
    using P = ChannelTextureParams;
    return {Kind::texture,
            "channel",
            "One channel of a picture as numbers.",
            "texture rough channel { of image \"packed.png\" space=data; take green }",
            false,
            {
                field<P, TexturedNumber>(FieldType::number, "of", &P::of)
                    .required()
                    .synonyms({"texture", "map", "image", "input"})
                    .doc("The picture; numbers in it are as stored with `space=data`.")
                    .example("of image \"packed.png\" space=data"),
                field<P, ColorChannel>(FieldType::choice, "take", &P::take)
                    .words(kChannelWords)
                    .synonyms({"channel"})
                    .doc("Which one.")
                    .example("take green"),
            }};
}

} // namespace abbe
