// Textures of glTF as textures of scenes, and the products of textures and factors that its parameters are.
#pragma once

#include "exchange/gltf/gltf_context.h"

#include <functional>
#include <tuple>

namespace abbe::exchange {

// How the texels of an image are meant: sRGB, numbers, or its alpha alone.
enum class GltfTexels : std::uint8_t { color, data, alpha };

// A texture as a material refers to it. Images have v = 0 at the top there and at the bottom here, where meshes have
// turned coordinates.
struct GltfTextureUse {
    int texture = -1;                                                      // none
    int set = 0;                                                           // TEXCOORD_0 or TEXCOORD_1
    double scaleU = 1, scaleV = 1, rotation = 0, offsetU = 0, offsetV = 0; // of KHR_texture_transform
    std::string where;                                                     // "baseColorTexture of material `A`"
    Span span;

    explicit operator bool() const { return texture >= 0; }
};

// A factor of a product: appends what it is.
using GltfFactor = std::function<void(SceneNode&)>;
// Their product; 1 where there is none.
void writeGltfProduct(SceneNode& at, const std::vector<GltfFactor>&);
// A colour, as a plain number where it is grey.
void writeGltfColor(SceneNode& at, Vec3d);

class GltfTextures {
  public:
    explicit GltfTextures(GltfContext& ctx) : ctx_(ctx) {}

    // What a reference to a texture says; with its index and `texCoord`, and extensions. What cannot be used is said
    // and gives none: no such texture, an image that is not there or of a format that nobody reads here.
    GltfTextureUse use(int index, int texCoord, const tinygltf::ExtensionMap&, std::string where, Span);
    template <typename Info> GltfTextureUse use(const Info& info, std::string where, Span span) {
        return use(info.index, info.texCoord, info.extensions, std::move(where), span);
    }

    // Appends the texture; its definition is made once.
    void write(SceneNode& at, const GltfTextureUse&, GltfTexels);
    // One channel, "red", "green" or "blue", of numbers.
    void writeChannel(SceneNode& at, const GltfTextureUse&, std::string_view channel);
    bool hasAlpha(const GltfTextureUse&);

  private:
    struct Image {
        std::string path; // as the scene names it; empty: it cannot be used, which is said
        bool alpha = false;
    };
    int imageOf(const tinygltf::Texture&, int index) const;
    const Image& image(int index, Span);
    Image readImage(int index, Span);
    const std::string& definition(const GltfTextureUse&, GltfTexels);
    std::string wrap(const GltfTextureUse&);
    void placing(GltfTextureUse&, const tinygltf::ExtensionMap&);

    GltfContext& ctx_;
    std::map<int, Image> images_;
    std::map<std::tuple<int, std::string, GltfTexels>, std::string> names_; // by image and wrap
    std::set<int> filtersSaid_;
};

} // namespace abbe::exchange
