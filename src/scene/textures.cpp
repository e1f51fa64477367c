#include "scene/registry.h"
#include "scene/scene_builder.h"

namespace abbe {

const Texture* SceneBuilder::textureOf(schema::Reference reference) const {
    return reference.valid() ? textures_[reference.index].get() : nullptr;
}

// Like reference() of a material: a named texture is made once.
schema::Reference SceneBuilder::texture(const Definition& definition, Diagnostics& diagnostics) {
    const bool named = !definition.name.empty();
    if (named)
        if (const auto found = textureIndex_.find(&definition); found != textureIndex_.end()) return found->second;
    const std::size_t before = diagnostics.errorCount();
    const auto bindInto = [&](void* params) {
        schema::bind(definition, tree_, types_, *this, params, diagnostics);
        return diagnostics.errorCount() == before;
    };
    schema::Reference result;
    if (!definition.type) {
        bindInto(nullptr);
    } else if (auto made = makeTexture(definition.type->name, bindInto, diagnostics)) {
        result.index = static_cast<std::uint32_t>(textures_.size());
        textures_.push_back(std::move(made));
    }
    if (named) textureIndex_[&definition] = result;
    return result;
}

} // namespace abbe
