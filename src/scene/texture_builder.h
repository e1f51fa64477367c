// Textures, what they are made of, and whether they fit the shapes that show them.
#pragma once

#include "render/shape.h"
#include "render/texture.h"
#include "scene/build_context.h"
#include "textures/texture_store.h"

#include <memory>
#include <optional>
#include <vector>

namespace abbe {

// Makes a texture of its registered type from bound parameters; null after an error.
using MakeTexture = std::unique_ptr<Texture> (*)(const BindParams&, const std::shared_ptr<TextureStore>&, Diagnostics&);

// What a texture is asked to lie on.
struct TexturedShape {
    const schema::Definition& definition; // a shape or a light
    const Shape& shape;
    bool uvOnFaces = false; // see UnplacedShape
};

class TextureBuilder {
  public:
    using Definition = schema::Definition;
    struct Use {
        std::uint32_t texture;
        Span span; // where
    };

    explicit TextureBuilder(BuildContext& context) : context_(context) {}

    schema::Reference reference(const Definition&, Diagnostics&);
    // The texture made of a request, as part of the texture that is being made or, without one, ready for its use.
    const Texture* requested(schema::Reference made, const schema::TextureRequest&);
    // For who asks what it is like, before it is made ready for a use. Null for none.
    const Texture* unprepared(schema::Reference r) const { return r.valid() ? textures_[r.index].get() : nullptr; }
    // Null for none, or after an error at `user`.
    const Texture* textureFor(schema::Reference, TextureUse, Span user);

    // While a material is made, the textures that it asks for are noted, those of the materials that it is made of
    // included.
    void beginMaterial() { openUses_.emplace_back(); }
    std::vector<Use> endMaterial();
    void keepUses(std::uint32_t material, std::vector<Use>);
    void usePart(std::uint32_t material); // of the material that is being made, if one is

    // Errors where the textures of a material do not fit a shape.
    void check(schema::Reference material, const TexturedShape&);
    // The same for the texture of a light; false after an error.
    bool checkLight(const Texture&, Span where, const TexturedShape&);

    // What a texture of radiance makes of white: as `radiance rgb 1 1 1` in its colour space, or 1 if it has none.
    const Curve* white(const Texture&);

    void noteEffects(); // of what lights ask for
    std::vector<std::unique_ptr<Texture>> release() { return std::move(textures_); }

  private:
    struct Parts {
        std::uint32_t size = 1; // how many textures it asks at most, itself included
        // The textures that it is made of, and whether as numbers whatever it is asked for itself.
        std::vector<std::pair<std::uint32_t, bool>> parts;
    };
    struct OpenTexture {
        const Definition* definition;
        Parts made;
    };

    const std::shared_ptr<TextureStore>& store(); // made with the first call
    bool prepare(std::uint32_t, TextureUse, Span user);
    void checkTexture(std::uint32_t texture, Span where, const TexturedShape&);
    void checkAttributes(std::uint32_t texture, Span where, const TexturedShape&);

    BuildContext& context_;
    std::vector<std::unique_ptr<Texture>> textures_;
    std::vector<Parts> parts_; // like textures_
    std::shared_ptr<TextureStore> store_;
    std::vector<OpenTexture> openTextures_;          // being made, each for the one before
    std::vector<std::vector<Use>> openUses_;         // of materials being made
    std::map<std::uint32_t, std::vector<Use>> uses_; // of materials, with those that they are made of
    std::map<const RgbSpace*, const Curve*> whites_;
    std::vector<Span> lights_; // where lights ask for theirs
};

} // namespace abbe
