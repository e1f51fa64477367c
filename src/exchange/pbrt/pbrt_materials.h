// Materials of pbrt scenes. Each is written once, when it is defined; shapes that need one with an opacity of their own
// get a copy.
#pragma once

#include "exchange/pbrt/pbrt_textures.h"

#include <list>
#include <map>
#include <string>
#include <vector>

namespace abbe::exchange {

struct PbrtMaterial {
    std::string word;          // its name in the scene file; empty: the grey one that both programs have by default
    std::vector<PbrtUv> uvs{}; // the mappings of its textures; none: it needs no texture coordinates
    bool isStretched = false;  // its highlights lie along the texture's u
    bool lightEnters = false;  // what is inside and outside matters
    bool isInterface = false;  // no surface at all
    bool hasInterior = false;  // a medium of its own, `interior`
    std::string interior{};
    SceneNode node{"material"};
};

class PbrtMaterials {
  public:
    PbrtMaterials(PbrtShared& shared, PbrtTextures& textures) : shared_(shared), textures_(textures) {}

    // `MakeNamedMaterial` with its name, or `Material` with an empty one. The result lives as long as this.
    const PbrtMaterial* define(const std::string& name, const std::string& type, const PbrtParams&);
    // The named one; null where it is not defined yet or at all.
    const PbrtMaterial* find(std::string_view name) const;
    // The name in the scene file of one that may be defined later. Undefined ones are reported at the end.
    std::string wordOf(const std::string& name, Span);
    // A copy whose opacity is that of a shape's alpha: a number, or a texture.
    const PbrtMaterial* withOpacity(const PbrtMaterial&, const PbrtParams& shape);
    // The rest: E0802 for names that nobody defined.
    void finish();

  private:
    struct Making;

    void diffuse(Making&);
    void conductor(Making&);
    void dielectric(Making&);
    void thinDielectric(Making&);
    void diffuseTransmission(Making&);
    void coatedDiffuse(Making&);
    void coatedConductor(Making&);
    void hair(Making&);
    void subsurface(Making&);
    void mix(Making&);
    void measured(Making&);

    void metalIndex(Making&, SceneNode& index, std::string_view prefix, double relativeTo);
    void refractiveIndex(Making&, SceneNode& parent, std::string_view name, double absent);
    void coat(Making&, SceneNode& layered);
    // `prefix` as in "interface.roughness"; with `canStretch` the node has `anisotropy`.
    void roughness(Making&, SceneNode& parent, std::string_view prefix, bool canStretch, double absent = 0);
    void surface(Making&); // normal and displacement maps
    void spectrum(Making&, SceneNode& parent, std::string_view property, std::string_view param, double absent);

    PbrtShared& shared_;
    PbrtTextures& textures_;
    int unnamed_ = 0;
    std::list<PbrtMaterial> all_;
    std::map<std::string, const PbrtMaterial*, std::less<>> named_;
    std::map<std::string, std::pair<std::string, Span>, std::less<>> mentioned_; // words of names, and where
    std::map<std::string, const PbrtMaterial*, std::less<>> translucent_;        // copies, by what they are made of
};

} // namespace abbe::exchange
