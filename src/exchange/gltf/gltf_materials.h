// Materials of glTF: metal and roughness with the layers of the KHR extensions, as OpenPBR.
#pragma once

#include "exchange/gltf/gltf_textures.h"

namespace abbe::exchange {

// What a material becomes, and what its shapes must know of it.
struct GltfMaterial {
    std::string name;
    int uvSet = -1; // TEXCOORD that its textures use; -1: it has none
};

// How a primitive uses its material.
struct GltfUse {
    bool color = false, alpha = false; // it has such values at its vertices
    bool dark = false;                 // it cannot emit, as it is bent, or stretched while it moves
    auto operator<=>(const GltfUse&) const = default;
};

class GltfMaterials {
  public:
    explicit GltfMaterials(GltfContext& ctx) : ctx_(ctx), textures_(ctx) {}

    // Defined once for each kind of primitive; -1 is the default material of the format.
    const GltfMaterial& of(int material, GltfUse);

  private:
    GltfContext& ctx_;
    GltfTextures textures_;
    std::map<std::pair<int, GltfUse>, GltfMaterial> made_;
};

// One material while it is written (gltf_materials.cpp, and gltf_layers.cpp for what extensions add).
class GltfSurface {
  public:
    GltfSurface(const tinygltf::Material&, int index, GltfUse, GltfContext&, GltfTextures&);

    // Fills `material NAME …`.
    void write(SceneNode&);
    int uvSet() const { return uvSet_; }

  private:
    void writeUnlit(SceneNode&);
    void writeGloss(SceneNode&); // metalness and roughness
    bool writeOldGloss(SceneNode&);
    void writeNormal(SceneNode&);
    bool writeOpacity(SceneNode&);
    void writeEmission(SceneNode&, bool open);
    void writeIndex(SceneNode&);
    void writeTransmission(SceneNode&);
    void writeInside(SceneNode&, const GltfObject& volume);
    void writeDiffuseTransmission(SceneNode&, bool solid);
    void writeCoat(SceneNode&);
    void writeFuzz(SceneNode&);
    void writeFilm(SceneNode&);
    void writeAnisotropy(SceneNode&);
    void warnOfOthers(SceneNode&);

    GltfObject extension(const char* name) const;
    // None if it needs other coordinates than the textures before it.
    GltfTextureUse settle(GltfTextureUse);
    template <typename Info> GltfTextureUse texture(const Info& info, const char* parameter) {
        return settle(textures_.use(info, std::string(parameter) + " of " + where_, span_));
    }
    // `property` as factor times the channel of a texture; nothing where it is the default.
    void writeNumber(SceneNode&, const char* property, double factor, const GltfTextureUse&, std::string_view channel,
                     double otherwise);
    void writeColor(SceneNode&, const char* property, Vec3d factor, const GltfTextureUse&);
    std::vector<GltfFactor> baseColor();
    std::vector<GltfFactor> colorFactors(Vec3d factor, const GltfTextureUse&);
    bool emits() const;

    const tinygltf::Material& m_;
    GltfUse use_;
    GltfContext& ctx_;
    GltfTextures& textures_;
    std::string where_;
    Span span_;
    int uvSet_ = -1;
    Vec3d baseFactor_{1, 1, 1};
    double alphaFactor_ = 1;
    GltfTextureUse baseTexture_, roughnessTexture_;
    double roughness_ = 1;
    bool clear_ = false; // light goes through
};

} // namespace abbe::exchange
