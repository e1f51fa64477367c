#include "scene/texture_builder.h"

#include "scene/registry.h"
#include "schema/suggest.h"
#include "textures/attribute_texture.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// Textures are asked recursively for every point of a surface.
constexpr std::size_t kMaxTextureLevels = 32;
constexpr std::uint32_t kMaxTextureSize = 4096;

TextureUse useFor(const std::optional<schema::SpectrumRole>& role) {
    if (!role) return TextureUse::number;
    return *role == schema::SpectrumRole::albedo ? TextureUse::reflectance : TextureUse::light;
}

} // namespace

// What a texture is made of is asked for the same as the whole: a field of numbers for numbers, but heights for
// heights, which have derivatives.
bool TextureBuilder::prepare(std::uint32_t texture, TextureUse use, Span user) {
    if (!textures_[texture]->prepare(use, user, context_.diagnostics)) return false;
    for (const auto& [part, asNumber] : parts_[texture].parts)
        if (!prepare(part, asNumber && use != TextureUse::heights ? TextureUse::number : use, user)) return false;
    return true;
}

const Texture* TextureBuilder::textureFor(schema::Reference reference, TextureUse use, Span user) {
    if (!reference.valid() || !prepare(reference.index, use, user)) return nullptr;
    return textures_[reference.index].get();
}

schema::Reference TextureBuilder::reference(const Definition& definition, Diagnostics& diagnostics) {
    const auto bindInto = context_.binder(definition, diagnostics);
    if (std::ranges::find(openTextures_, &definition, &OpenTexture::definition) != openTextures_.end()) {
        if (definition.type) // else an error has been reported
            diagnostics.error("E0731", definition.span, fmt::format("texture `{}` is made of itself", definition.name),
                              "directly or through others");
        return {};
    }
    if (openTextures_.size() == kMaxTextureLevels) {
        diagnostics.error("E0732", definition.span, "textures stand too deeply within each other",
                          fmt::format("more than {} levels", kMaxTextureLevels));
        return {};
    }
    openTextures_.push_back({&definition, {}});
    if (!definition.type) {
        bindInto(nullptr);
        openTextures_.pop_back();
        return {};
    }
    auto made = makerOf<MakeTexture>(*definition.type)(bindInto, store(), diagnostics);
    Parts parts = std::move(openTextures_.back().made);
    openTextures_.pop_back();
    if (!made) return {};
    if (parts.size > kMaxTextureSize) {
        diagnostics.error("E0732", definition.span, "a texture is made of too many others",
                          fmt::format("more than {}", kMaxTextureSize));
        return {};
    }
    textures_.push_back(std::move(made));
    parts_.push_back(std::move(parts));
    return {static_cast<std::uint32_t>(textures_.size() - 1)};
}

const Texture* TextureBuilder::requested(schema::Reference made, const schema::TextureRequest& request) {
    if (!made.valid()) return nullptr;
    if (!openTextures_.empty()) { // made ready when it is known what the whole is for
        Parts& whole = openTextures_.back().made;
        whole.size = std::min(whole.size + parts_[made.index].size, kMaxTextureSize + 1);
        whole.parts.emplace_back(made.index, !request.role);
        return textures_[made.index].get();
    }
    if (!openUses_.empty()) openUses_.back().push_back({made.index, request.span});
    return textureFor(made, useFor(request.role), request.span);
}

std::vector<TextureBuilder::Use> TextureBuilder::endMaterial() {
    auto uses = std::move(openUses_.back());
    openUses_.pop_back();
    return uses;
}

void TextureBuilder::keepUses(std::uint32_t material, std::vector<Use> uses) {
    if (!uses.empty()) uses_.emplace(material, std::move(uses));
}

void TextureBuilder::usePart(std::uint32_t material) {
    if (openUses_.empty()) return;
    const auto found = uses_.find(material);
    if (found != uses_.end())
        openUses_.back().insert(openUses_.back().end(), found->second.begin(), found->second.end());
}

// Every attribute that a texture asks for, directly or in its parts.
void TextureBuilder::checkAttributes(std::uint32_t texture, Span where, const TexturedShape& on) {
    if (const auto* const attribute = dynamic_cast<const AttributeTexture*>(textures_[texture].get())) {
        const VertexAttributes* const attributes = on.shape.attributes();
        const auto names = attributes ? attributes->attributeNames() : std::vector<std::string_view>{};
        if (std::ranges::find(names, attribute->name()) != names.end()) return;
        auto& d = context_.diagnostics.error(
            "E0734", where, fmt::format("the shape has no attribute `{}`", attribute->name()), "this texture");
        d.related.push_back({on.definition.span, "on this shape"});
        const std::string_view meant = schema::nearest(attribute->name(), {names.begin(), names.end()});
        d.help = names.empty()   ? "attributes are the vertex properties of a PLY file, or `attribute` beside `points`"
                 : meant.empty() ? "its attributes are " + schema::quotedList(names)
                                 : schema::didYouMean(meant) + " it has " + schema::quotedList(names);
    }
    for (const auto& [part, asNumber] : parts_[texture].parts) checkAttributes(part, where, on);
}

// Images need texture coordinates; boxes have them on every face.
void TextureBuilder::checkTexture(std::uint32_t texture, Span where, const TexturedShape& on) {
    checkAttributes(texture, where, on);
    const bool coordinates = on.shape.hasTextureCoordinates() || on.uvOnFaces;
    if (coordinates || !textures_[texture]->needsUv()) return;
    auto& d = context_.diagnostics.error("E0733", where, "a texture over uv is on a shape without texture coordinates",
                                         "this texture");
    d.related.push_back({on.definition.span, "on this shape"});
    d.help = "give it texture coordinates (`uvs` beside `points`), or use a texture in space: `noise`, `triplanar`";
}

void TextureBuilder::check(schema::Reference material, const TexturedShape& on) {
    const auto found = material.valid() ? uses_.find(material.index) : uses_.end();
    if (found == uses_.end()) return;
    for (const Use& use : found->second) checkTexture(use.texture, use.span, on);
}

bool TextureBuilder::checkLight(const Texture& texture, Span where, const TexturedShape& on) {
    const std::size_t before = context_.diagnostics.errorCount();
    const auto found = std::ranges::find(textures_, &texture, &std::unique_ptr<Texture>::get);
    checkTexture(static_cast<std::uint32_t>(found - textures_.begin()), where, on);
    lights_.push_back(where);
    return context_.diagnostics.errorCount() == before;
}

const Curve* TextureBuilder::white(const Texture& texture) {
    const RgbSpace* const space = texture.rgbSpace();
    const Curve*& white = whites_[space];
    if (!white) white = space ? context_.curves.white(*space) : context_.curves.constant(1);
    return white;
}

void TextureBuilder::noteEffects() {
    for (const Span span : lights_) context_.noteEffect(Effect::textures, span, "its light follows a texture");
}

const std::shared_ptr<TextureStore>& TextureBuilder::store() {
    if (!store_) {
        TextureStoreSettings settings;
        settings.bytes = static_cast<std::int64_t>(context_.built.render.textureCache * 1048576);
        settings.open = context_.options.geometry || context_.options.textures;
        SceneReuse* const reuse = context_.reuse;
        const bool kept = reuse && reuse->textures && reuse->textures->settings() == settings;
        store_ = kept ? reuse->textures : std::make_shared<TextureStore>(std::move(settings));
        if (reuse) reuse->textures = store_;
    }
    return store_;
}

} // namespace abbe
