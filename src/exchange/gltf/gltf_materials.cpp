#include "exchange/gltf/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Factors of colours lie between 0 and 1, alpha too.
double gltfEntry(const std::vector<double>& values, std::size_t i, double otherwise) {
    return i < values.size() && std::isfinite(values[i]) ? std::clamp(values[i], 0.0, 1.0) : otherwise;
}

constexpr const char* kOldGloss = "KHR_materials_pbrSpecularGlossiness";

} // namespace

const GltfMaterial& GltfMaterials::of(int material, GltfUse use) {
    const auto [at, isNew] = made_.try_emplace({material, use});
    GltfMaterial& made = at->second;
    if (!isNew) return made;
    static const tinygltf::Material kDefault;
    const auto& all = ctx_.model().materials;
    const bool known = material >= 0 && static_cast<std::size_t>(material) < all.size();
    const tinygltf::Material& m = known ? all[static_cast<std::size_t>(material)] : kDefault;
    made.name = ctx_.materialNames.take(m.name, known ? fmt::format("material-{}", material) : "default");
    SceneNode node("material");
    node.name(made.name);
    GltfSurface surface(m, material, use, ctx_, textures_);
    surface.write(node);
    made.uvSet = surface.uvSet();
    ctx_.import.nodes.push_back(std::move(node));
    return made;
}

GltfSurface::GltfSurface(const tinygltf::Material& m, int index, GltfUse use, GltfContext& ctx, GltfTextures& textures)
    : m_(m), use_(use), ctx_(ctx), textures_(textures), where_(gltfName("material", "materials", index, m.name)),
      span_(ctx.places.of("materials", index)) {
    const auto& p = m.pbrMetallicRoughness;
    baseFactor_ = {gltfEntry(p.baseColorFactor, 0, 1), gltfEntry(p.baseColorFactor, 1, 1),
                   gltfEntry(p.baseColorFactor, 2, 1)};
    alphaFactor_ = gltfEntry(p.baseColorFactor, 3, 1);
}

GltfObject GltfSurface::extension(const char* name) const { return {m_.extensions, name, where_, span_, ctx_.import}; }

GltfTextureUse GltfSurface::settle(GltfTextureUse use) {
    if (!use) return use;
    if (uvSet_ < 0) uvSet_ = use.set;
    if (use.set == uvSet_) return use;
    ctx_.import.leftOut(
        nullptr, span_, use.where,
        fmt::format("it uses TEXCOORD_{}, the material's first texture TEXCOORD_{}; shapes have one", use.set, uvSet_));
    use.texture = -1;
    return use;
}

void GltfSurface::writeNumber(SceneNode& at, const char* property, double factor, const GltfTextureUse& texture,
                              std::string_view channel, double otherwise) {
    if (!texture || factor == 0) {
        if (factor != otherwise) at.child(property).number(factor);
        return;
    }
    std::vector<GltfFactor> factors;
    factors.emplace_back([&](SceneNode& node) {
        if (channel == "alpha")
            textures_.write(node, texture, GltfTexels::alpha);
        else
            textures_.writeChannel(node, texture, channel);
    });
    if (channel == "alpha" && !textures_.hasAlpha(texture)) factors.clear(); // it is 1 everywhere
    if (factor != 1 || factors.empty()) factors.emplace_back([=](SceneNode& node) { node.number(factor); });
    writeGltfProduct(at.child(property), factors);
}

std::vector<GltfFactor> GltfSurface::colorFactors(Vec3d factor, const GltfTextureUse& texture) {
    std::vector<GltfFactor> factors;
    if (texture) factors.emplace_back([=, this](SceneNode& at) { textures_.write(at, texture, GltfTexels::color); });
    if (!texture || factor != Vec3d(1, 1, 1)) factors.emplace_back([=](SceneNode& at) { writeGltfColor(at, factor); });
    return factors;
}

void GltfSurface::writeColor(SceneNode& at, const char* property, Vec3d factor, const GltfTextureUse& texture) {
    writeGltfProduct(at.child(property), colorFactors(factor, texture));
}

std::vector<GltfFactor> GltfSurface::baseColor() {
    std::vector<GltfFactor> factors = colorFactors(baseFactor_, baseTexture_);
    if (!use_.color) return factors;
    if (!baseTexture_ && baseFactor_ == Vec3d(1, 1, 1)) factors.clear();
    factors.emplace_back([](SceneNode& at) { at.word("attribute").text("color"); });
    return factors;
}

void GltfSurface::write(SceneNode& node) {
    const bool unlit = m_.extensions.contains("KHR_materials_unlit");
    const bool old = m_.extensions.contains(kOldGloss);
    if (!old) baseTexture_ = texture(m_.pbrMetallicRoughness.baseColorTexture, "baseColorTexture");
    if (unlit) {
        writeUnlit(node);
        warnOfOthers(node);
        return;
    }
    node.word("openpbr");
    if (!old || !writeOldGloss(node)) {
        writeGltfProduct(node.child("base-color"), baseColor());
        writeGloss(node);
        writeIndex(node);
    }
    writeTransmission(node);
    writeCoat(node);
    writeFuzz(node);
    writeFilm(node);
    writeNormal(node);
    const bool open = writeOpacity(node);
    writeEmission(node, open);
    warnOfOthers(node);
}

void GltfSurface::writeUnlit(SceneNode& node) {
    ctx_.import.approximated(&node, span_, fmt::format("KHR_materials_unlit of {}", where_),
                             "matte, of its base colour: it takes light as all else does");
    node.word("diffuse");
    writeGltfProduct(node.child("reflectance"), baseColor());
    writeOpacity(node);
}

void GltfSurface::writeGloss(SceneNode& node) {
    const auto& p = m_.pbrMetallicRoughness;
    const auto share = [&](double value, const char* name) {
        return gltfShare(value, name, where_, span_, ctx_.import);
    };
    roughnessTexture_ = texture(p.metallicRoughnessTexture, "metallicRoughnessTexture");
    roughness_ = share(p.roughnessFactor, "roughnessFactor");
    writeNumber(node, "base-metalness", share(p.metallicFactor, "metallicFactor"), roughnessTexture_, "blue", 0);
    writeAnisotropy(node);
    writeNumber(node, "specular-roughness", roughness_, roughnessTexture_, "green", 0.3);
}

// The other way to say it, of the time before glTF 2.0's extensions: the gloss has a colour of its own.
bool GltfSurface::writeOldGloss(SceneNode& node) {
    const GltfObject old = extension(kOldGloss);
    if (!old) return false;
    const Vec3d diffuse = old.color("diffuseFactor", {1, 1, 1}), specular = old.color("specularFactor", {1, 1, 1});
    if (const tinygltf::Value* const four = old.find("diffuseFactor"); four && four->ArrayLen() == 4)
        if (four->Get(3).IsNumber()) alphaFactor_ = std::clamp(four->Get(3).GetNumberAsDouble(), 0.0, 1.0);
    const double gloss = old.share("glossinessFactor", 1),
                 most = std::min(1.0, std::max({specular.x, specular.y, specular.z}));
    baseTexture_ = texture(old.texture("diffuseTexture"), "diffuseTexture");
    const GltfTextureUse texture = this->texture(old.texture("specularGlossinessTexture"), "specularGlossinessTexture");
    // What its gloss does not reflect: 1 - max(specular).
    baseFactor_ = min(diffuse, Vec3d(1, 1, 1)) * (texture ? 1 : 1 - std::min(1.0, most));
    writeGltfProduct(node.child("base-color"), baseColor());
    constexpr double kReflectance = 0.04; // of the default index, 1.5
    node.child("specular-weight").number(texture ? 1 / kReflectance : most / kReflectance);
    if (texture || most > 0)
        writeColor(node, "specular-color",
                   texture ? min(specular, Vec3d(1, 1, 1)) : min(specular * (1 / most), Vec3d(1, 1, 1)), texture);
    if (texture && gloss > 0 && textures_.hasAlpha(texture)) {
        SceneNode& ramp = node.child("specular-roughness").word("ramp");
        textures_.write(ramp.child("input"), texture, GltfTexels::alpha);
        ramp.child("stop").number(0).number(1);
        ramp.child("stop").number(1).number(1 - gloss);
    } else {
        node.child("specular-roughness").number(1 - gloss);
    }
    ctx_.import.approximated(&node, span_, old.where(), "its coloured gloss is that of a dielectric");
    old.warnOfUnused();
    return true;
}

void GltfSurface::writeNormal(SceneNode& node) {
    const GltfTextureUse use = texture(m_.normalTexture, "normalTexture");
    if (!use) return;
    SceneNode& normal = node.child("normal");
    textures_.write(normal, use, GltfTexels::data);
    if (m_.normalTexture.scale != 1) normal.key("strength", m_.normalTexture.scale);
}

bool GltfSurface::writeOpacity(SceneNode& node) {
    const std::string& mode = m_.alphaMode;
    if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
        ctx_.import.diagnostics.error("E0802", span_,
                                      fmt::format("alphaMode of {} is `{}`, not OPAQUE, MASK or BLEND", where_, mode));
    if (mode != "MASK" && mode != "BLEND") return false;
    std::vector<GltfFactor> factors;
    if (baseTexture_ && textures_.hasAlpha(baseTexture_))
        factors.emplace_back([&](SceneNode& at) { textures_.write(at, baseTexture_, GltfTexels::alpha); });
    if (use_.alpha) factors.emplace_back([](SceneNode& at) { at.word("attribute").text("alpha"); });
    if (mode == "BLEND") {
        if (factors.empty() && alphaFactor_ == 1) return false;
        if (alphaFactor_ < 1 || factors.empty()) factors.emplace_back([&](SceneNode& at) { at.number(alphaFactor_); });
        writeGltfProduct(node.child("opacity"), factors);
        return true;
    }
    constexpr double kReached = 1 - 1e-6; // of the cutoff: alpha that is equal to it is seen
    const double cutoff = std::isfinite(m_.alphaCutoff) ? m_.alphaCutoff : 0.5;
    if (cutoff <= 0 || (factors.empty() && alphaFactor_ >= cutoff)) return false;
    if (factors.empty() || alphaFactor_ < cutoff) {
        node.child("opacity").number(0);
        return true;
    }
    SceneNode& ramp = node.child("opacity").word("ramp");
    writeGltfProduct(ramp.child("input"), factors);
    const double edge = cutoff / alphaFactor_ * kReached;
    ramp.child("stop").number(edge).number(0);
    ramp.child("stop").number(edge).number(1);
    return true;
}

bool GltfSurface::emits() const {
    return std::ranges::any_of(m_.emissiveFactor, [](double x) { return x > 0; });
}

void GltfSurface::writeEmission(SceneNode& node, bool open) {
    const GltfObject strong = extension("KHR_materials_emissive_strength");
    constexpr double kMostNits = 1e12;
    const double stated = strong.positive("emissiveStrength", 1), strength = std::min(stated, kMostNits / ctx_.nit);
    strong.warnOfUnused();
    if (strength < stated)
        ctx_.import.approximated(&node, span_, fmt::format("what {} emits", where_),
                                 "it has 1e12 nits, the most there is");
    if (!emits() || strength == 0) return;
    if (use_.dark)
        return ctx_.import.leftOut(&node, span_, fmt::format("what {} emits", where_),
                                   "it is bent, or stretched while it moves, and its area changes");
    if (open)
        return ctx_.import.leftOut(&node, span_, fmt::format("what {} emits", where_),
                                   "a surface with holes cannot emit");
    const Vec3d factor{gltfEntry(m_.emissiveFactor, 0, 0), gltfEntry(m_.emissiveFactor, 1, 0),
                       gltfEntry(m_.emissiveFactor, 2, 0)};
    const GltfTextureUse use = texture(m_.emissiveTexture, "emissiveTexture");
    node.child("emission-luminance").number(strength * ctx_.nit).word("nits");
    if (use || factor != Vec3d(1, 1, 1)) writeColor(node, "emission-color", factor, use);
}

void GltfSurface::warnOfOthers(SceneNode& node) {
    constexpr std::array<std::string_view, 14> kKnown = {"KHR_materials_unlit",
                                                         kOldGloss,
                                                         "KHR_materials_emissive_strength",
                                                         "KHR_materials_ior",
                                                         "KHR_materials_specular",
                                                         "KHR_materials_transmission",
                                                         "KHR_materials_volume",
                                                         "KHR_materials_dispersion",
                                                         "KHR_materials_diffuse_transmission",
                                                         "KHR_materials_clearcoat",
                                                         "KHR_materials_sheen",
                                                         "KHR_materials_iridescence",
                                                         "KHR_materials_anisotropy",
                                                         "KHR_materials_variants"};
    for (const auto& [name, value] : m_.extensions)
        if (std::ranges::find(kKnown, name) == kKnown.end())
            ctx_.import.leftOut(&node, span_, fmt::format("{} of {}", name, where_), "it has no counterpart here");
}

} // namespace abbe::exchange
