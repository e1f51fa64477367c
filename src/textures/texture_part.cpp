#include "textures/texture_part.h"

namespace abbe {

TextureJet TexturePart::jet(const TexturePoint& point, int channels) const noexcept {
    if (texture_) {
        const int own = std::min(channels, texture_->channels());
        TextureJet j = texture_->jet(point, own);
        const auto repeat = [&](Vec3& v) { v = {v.x, own > 1 ? v.y : v.x, own > 2 ? v.z : v.x}; };
        repeat(j.value);
        for (Vec3& d : j.byPosition) repeat(d);
        for (Vec3& d : j.byUv) repeat(d);
        return j;
    }
    TextureJet j;
    j.value = {number_, number_, number_};
    return j;
}

void TexturePart::prepare(TextureUse use, Span user, Diagnostics& diagnostics) const {
    if (!curve_ || curve_->isConstant() || use == TextureUse::reflectance || use == TextureUse::light) return;
    diagnostics
        .warning("W0730", user, "a coloured spectrum in this texture is taken for a number", "its value at 550 nm")
        .help = "write plain numbers where no colour is asked for";
}

} // namespace abbe
