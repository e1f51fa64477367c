#include "scene/registry.h"
#include "scene/scene_builder.h"

namespace abbe {

const Texture* SceneBuilder::textureFor(schema::Reference reference, TextureUse use, Span user) {
    if (!reference.valid()) return nullptr;
    Texture* const texture = textures_[reference.index].get();
    return texture->prepare(use, user, diagnostics_) ? texture : nullptr;
}

schema::Reference SceneBuilder::textureReference(const Definition& definition, Diagnostics& diagnostics) {
    const auto bindInto = binder(definition, diagnostics);
    if (!definition.type) {
        bindInto(nullptr);
        return {};
    }
    auto made = makeTexture(definition.type->name, bindInto, diagnostics);
    if (!made) return {};
    textures_.push_back(std::move(made));
    return {static_cast<std::uint32_t>(textures_.size() - 1)};
}

} // namespace abbe
