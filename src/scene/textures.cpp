#include "scene/registry.h"
#include "scene/scene_builder.h"
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

// What a texture is made of is asked for the same as the whole.
bool SceneBuilder::prepareTexture(std::uint32_t texture, TextureUse use, Span user) {
    if (!textures_[texture]->prepare(use, user, diagnostics_)) return false;
    for (const auto& [part, asNumber] : textureParts_[texture].parts)
        if (!prepareTexture(part, asNumber ? TextureUse::number : use, user)) return false;
    return true;
}

const Texture* SceneBuilder::textureFor(schema::Reference reference, TextureUse use, Span user) {
    if (!reference.valid() || !prepareTexture(reference.index, use, user)) return nullptr;
    return textures_[reference.index].get();
}

schema::Reference SceneBuilder::textureReference(const Definition& definition, Diagnostics& diagnostics) {
    const auto bindInto = binder(definition, diagnostics);
    if (!definition.type) {
        bindInto(nullptr);
        return {};
    }
    if (std::ranges::find(openTextures_, &definition, &OpenTexture::definition) != openTextures_.end()) {
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
    auto made = makeTexture(definition.type->name, bindInto, textureStore(), diagnostics);
    TextureParts parts = std::move(openTextures_.back().made);
    openTextures_.pop_back();
    if (!made) return {};
    if (parts.size > kMaxTextureSize) {
        diagnostics.error("E0732", definition.span, "a texture is made of too many others",
                          fmt::format("more than {}", kMaxTextureSize));
        return {};
    }
    textures_.push_back(std::move(made));
    textureParts_.push_back(std::move(parts));
    return {static_cast<std::uint32_t>(textures_.size() - 1)};
}

const Texture* SceneBuilder::texture(const schema::TextureRequest& request, Diagnostics& diagnostics) {
    const schema::Reference made = reference(request.definition, diagnostics);
    if (!made.valid()) return nullptr;
    if (!openTextures_.empty()) { // made ready when it is known what the whole is for
        TextureParts& whole = openTextures_.back().made;
        whole.size = std::min(whole.size + textureParts_[made.index].size, kMaxTextureSize + 1);
        whole.parts.emplace_back(made.index, !request.role);
        return textures_[made.index].get();
    }
    if (!openAskers_.empty()) openAskers_.back().push_back({made.index, request.span});
    return textureFor(made, useFor(request.role), request.span);
}

void SceneBuilder::askTextures(std::uint32_t material) {
    if (openAskers_.empty()) return;
    const auto found = textureAskers_.find(material);
    if (found != textureAskers_.end())
        openAskers_.back().insert(openAskers_.back().end(), found->second.begin(), found->second.end());
}

// Every attribute that a texture asks for, directly or in its parts.
void SceneBuilder::checkAttributes(std::uint32_t texture, Span asker, const Definition& owner, const Shape& shape) {
    if (const auto* const attribute = dynamic_cast<const AttributeTexture*>(textures_[texture].get())) {
        const auto names = shape.attributeNames();
        if (std::ranges::find(names, attribute->name()) != names.end()) return;
        auto& d = diagnostics_.error("E0734", asker, fmt::format("the shape has no attribute `{}`", attribute->name()),
                                     "this texture");
        d.related.push_back({owner.span, "on this shape"});
        const std::string_view meant = schema::nearest(attribute->name(), {names.begin(), names.end()});
        d.help = names.empty()   ? "attributes are the vertex properties of a PLY file, or `attribute` beside `points`"
                 : meant.empty() ? "its attributes are " + schema::quotedList(names)
                                 : schema::didYouMean(meant) + " it has " + schema::quotedList(names);
    }
    for (const auto& [part, asNumber] : textureParts_[texture].parts) checkAttributes(part, asker, owner, shape);
}

// Images need texture coordinates; boxes have them on every face.
void SceneBuilder::checkTexture(std::uint32_t texture, Span asker, const Definition& owner, const Shape& shape) {
    checkAttributes(texture, asker, owner, shape);
    const bool coordinates = shape.hasTextureCoordinates() || (owner.type && owner.type->name == "box");
    if (coordinates || !textures_[texture]->needsUv()) return;
    auto& d = diagnostics_.error("E0733", asker, "a texture over uv is on a shape without texture coordinates",
                                 "this texture");
    d.related.push_back({owner.span, "on this shape"});
    d.help = "give it texture coordinates (`uvs` beside `points`), or use a texture in space: `noise`, `triplanar`";
}

void SceneBuilder::checkTextures(const LoadedShape& loaded, const Shape& shape) {
    const auto check = [&](const schema::Reference& material) {
        const auto found = material.valid() ? textureAskers_.find(material.index) : textureAskers_.end();
        if (found == textureAskers_.end()) return;
        for (const TextureAsker& asker : found->second)
            checkTexture(asker.texture, asker.span, *loaded.definition, shape);
    };
    check(loaded.common.material);
    for (const schema::GroupReference& group : loaded.common.groupMaterials) check(group.reference);
}

bool SceneBuilder::checkLightTexture(const Texture& texture, Span asker, const Definition& owner, const Shape& shape) {
    const std::size_t before = diagnostics_.errorCount();
    const auto found = std::ranges::find(textures_, &texture, &std::unique_ptr<Texture>::get);
    checkTexture(static_cast<std::uint32_t>(found - textures_.begin()), asker, owner, shape);
    lightTextures_.push_back(asker);
    return diagnostics_.errorCount() == before;
}

const std::shared_ptr<TextureStore>& SceneBuilder::textureStore() {
    if (!textureStore_) {
        TextureStoreSettings settings;
        settings.bytes = static_cast<std::int64_t>(built_->render.textureCache * 1048576);
        settings.open = options_.geometry || options_.textures;
        textureStore_ = std::make_shared<TextureStore>(std::move(settings));
    }
    return textureStore_;
}

} // namespace abbe
