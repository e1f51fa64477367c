#include "scene/registry.h"
#include "scene/scene_builder.h"

namespace abbe {

const Texture* SceneBuilder::textureOf(schema::Reference reference) const {
    return reference.valid() ? textures_[reference.index].get() : nullptr;
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
