// What extensions add to a material: index, transmission, coat, fuzz, film and stretched highlights.
#include "exchange/gltf/gltf_materials.h"
#include "exchange/gltf/gltf_textures.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

void GltfSurface::writeIndex(SceneNode& node) {
    const GltfObject index = extension("KHR_materials_ior"), specular = extension("KHR_materials_specular");
    double weight = specular.share("specularFactor", 1);
    Vec3d color = specular.color("specularColorFactor", {1, 1, 1});
    const double ior = index.number("ior", 1.5);
    if (ior == 0) { // a word of the extension: all is reflected from everywhere
        weight *= 25;
    } else {
        if (!(ior >= 1 && ior <= 10))
            ctx_.import.approximated(&node, span_, index.where(), fmt::format("{} is no index from 1 to 10", ior));
        if (ior != 1.5) node.child("specular-ior").number(std::clamp(ior, 1.0, 10.0));
    }
    const double most = std::max({color.x, color.y, color.z});
    constexpr double kMostWeight = 1e6; // all is reflected long before
    if (most > 1) {
        weight = std::min(weight * most, kMostWeight);
        color = color * (1 / most);
    }
    const GltfTextureUse weightMap = texture(specular.texture("specularTexture"), "specularTexture"),
                         colorMap = texture(specular.texture("specularColorTexture"), "specularColorTexture");
    if (weightMap && textures_.hasAlpha(weightMap) && weight > 1)
        ctx_.import.approximated(&node, span_, specular.where(), "its texture is taken for a factor of 1 at most");
    writeNumber(node, "specular-weight", weightMap ? std::min(weight, 1.0) : weight, weightMap, "alpha", 1);
    if (colorMap || color != Vec3d(1, 1, 1)) writeColor(node, "specular-color", color, colorMap);
    index.warnOfUnused();
    specular.warnOfUnused();
}

void GltfSurface::writeTransmission(SceneNode& node) {
    const GltfObject transmission = extension("KHR_materials_transmission"), volume = extension("KHR_materials_volume"),
                     dispersion = extension("KHR_materials_dispersion");
    const double weight = transmission.share("transmissionFactor", 0);
    const GltfTextureUse map = texture(transmission.texture("transmissionTexture"), "transmissionTexture");
    const bool solid = weight > 0 && volume.positive("thicknessFactor", 0) > 0;
    transmission.warnOfUnused();
    const double spread = dispersion.positive("dispersion", 0); // 20 over the Abbe number
    dispersion.warnOfUnused();
    clear_ = weight > 0;
    if (clear_) writeNumber(node, "transmission-weight", weight, map, "red", 0);
    if (solid) {
        writeInside(node, volume);
        if (spread > 0) node.child("transmission-dispersion-scale").number(std::min(spread, 1.0));
        if (spread > 1) node.child("transmission-dispersion-abbe-number").number(std::max(5.0, 20 / spread));
    } else if (clear_) {
        node.child("geometry-thin-walled").word("on");
        writeGltfProduct(node.child("transmission-color"), baseColor());
    }
    writeDiffuseTransmission(node, solid);
    for (const char* name : {"thicknessFactor", "thicknessTexture", "attenuationDistance", "attenuationColor"})
        volume.find(name); // thickness is that of the shape itself
    volume.warnOfUnused();
}

// Light is tinted by the base colour at the surface, there, and by the way inside; here by one of them.
void GltfSurface::writeInside(SceneNode& node, const GltfObject& volume) {
    const double distance = volume.positive("attenuationDistance", 0); // left out: infinite
    const Vec3d color = min(volume.color("attenuationColor", {1, 1, 1}), Vec3d(1, 1, 1));
    constexpr double kFarthest = 1e9; // m: then it is as good as clear
    const bool absorbs = distance > 0 && distance < kFarthest && color != Vec3d(1, 1, 1);
    const bool tinted = baseTexture_ || use_.color || baseFactor_ != Vec3d(1, 1, 1);
    if (!absorbs) {
        if (tinted) writeGltfProduct(node.child("transmission-color"), baseColor());
        return;
    }
    if (tinted)
        ctx_.import.leftOut(&node, span_, fmt::format("the tint of the base colour on the glass of {}", where_),
                            "the inside has a colour already, attenuationColor");
    writeColor(node, "transmission-color", color, {});
    node.child("transmission-depth").number(distance).word("m");
}

void GltfSurface::writeDiffuseTransmission(SceneNode& node, bool solid) {
    const GltfObject through = extension("KHR_materials_diffuse_transmission");
    const double weight = through.share("diffuseTransmissionFactor", 0);
    const Vec3d color = min(through.color("diffuseTransmissionColorFactor", {1, 1, 1}), Vec3d(1, 1, 1));
    const GltfTextureUse map = texture(through.texture("diffuseTransmissionTexture"), "diffuseTransmissionTexture"),
                         colorMap = texture(through.texture("diffuseTransmissionColorTexture"),
                                            "diffuseTransmissionColorTexture");
    through.warnOfUnused();
    if (weight == 0) return;
    if (solid)
        return ctx_.import.leftOut(&node, span_, through.where(),
                                   "the inside is clear, as KHR_materials_transmission says");
    if (extension("KHR_materials_volume").positive("thicknessFactor", 0) > 0)
        ctx_.import.approximated(&node, span_, fmt::format("KHR_materials_volume of {}", where_),
                                 "with diffuse transmission it is a thin sheet");
    if (!clear_) node.child("geometry-thin-walled").word("on");
    writeNumber(node, "subsurface-weight", weight, map, "alpha", 0);
    writeColor(node, "subsurface-color", color, colorMap);
    node.child("subsurface-scatter-anisotropy").number(1); // all of it goes through
}

void GltfSurface::writeCoat(SceneNode& node) {
    const GltfObject coat = extension("KHR_materials_clearcoat");
    const double weight = coat.share("clearcoatFactor", 0);
    const GltfTextureUse map = texture(coat.texture("clearcoatTexture"), "clearcoatTexture"),
                         roughnessMap = texture(coat.texture("clearcoatRoughnessTexture"), "clearcoatRoughnessTexture"),
                         normal = texture(coat.texture("clearcoatNormalTexture"), "clearcoatNormalTexture");
    const double roughness = coat.share("clearcoatRoughnessFactor", 0);
    coat.warnOfUnused();
    if (weight == 0) return;
    writeNumber(node, "coat-weight", weight, map, "red", 0);
    writeNumber(node, "coat-roughness", roughness, roughnessMap, "green", 0);
    node.child("coat-ior").number(1.5);
    node.child("coat-darkening").number(0);
    if (normal)
        textures_.write(node.child("geometry-coat-normal"), normal, GltfTexels::data);
    else if (m_.normalTexture.index >= 0)
        node.child("geometry-coat-normal").number(0); // its own normal is that of the shape
    if (normal)
        if (const tinygltf::Value* const info = coat.find("clearcoatNormalTexture"); info->Has("scale"))
            ctx_.import.leftOut(&node, span_, fmt::format("the scale of {}", normal.where), "it is taken as 1");
}

// A cloth of a dark colour has fewer fibres there, and here darker ones.
void GltfSurface::writeFuzz(SceneNode& node) {
    const GltfObject sheen = extension("KHR_materials_sheen");
    const Vec3d color = min(sheen.color("sheenColorFactor", {}), Vec3d(1, 1, 1));
    GltfTextureUse map = texture(sheen.texture("sheenColorTexture"), "sheenColorTexture"),
                   roughnessMap = texture(sheen.texture("sheenRoughnessTexture"), "sheenRoughnessTexture");
    const double roughness = sheen.share("sheenRoughnessFactor", 0), most = std::max({color.x, color.y, color.z});
    sheen.warnOfUnused();
    if (most == 0) return;
    ctx_.import.approximated(&node, span_, sheen.where(), "fibres of another model, of about that look");
    if (roughnessMap && emits()) {
        ctx_.import.leftOut(&node, span_, roughnessMap.where, "over a surface that emits it is one number");
        roughnessMap = {};
    }
    node.child("fuzz-weight").number(most);
    if (map || color != Vec3d(most, most, most)) writeColor(node, "fuzz-color", color * (1 / most), map);
    writeNumber(node, "fuzz-roughness", roughness, roughnessMap, "alpha", 0.5);
}

void GltfSurface::writeFilm(SceneNode& node) {
    const GltfObject film = extension("KHR_materials_iridescence");
    const double weight = film.share("iridescenceFactor", 0), least = film.positive("iridescenceThicknessMinimum", 100),
                 most = film.positive("iridescenceThicknessMaximum", 400), ior = film.number("iridescenceIor", 1.3);
    const GltfTextureUse map = texture(film.texture("iridescenceTexture"), "iridescenceTexture"),
                         thickness =
                             texture(film.texture("iridescenceThicknessTexture"), "iridescenceThicknessTexture");
    film.warnOfUnused();
    if (weight == 0) return;
    writeNumber(node, "thin-film-weight", weight, map, "red", 0);
    node.child("thin-film-ior").number(std::clamp(ior, 1.0, 10.0));
    const double thickest = std::min(thickness ? std::max(least, most) : most, 1e6);
    SceneNode& depth = node.child("thin-film-thickness").number(thickest).word("nm");
    if (!thickness || least == most || thickest == 0) return;
    SceneNode& ramp = depth.child("map").word("ramp");
    textures_.writeChannel(ramp.child("input"), thickness, "green");
    ramp.child("stop").number(0).number(std::min(least, thickest) / thickest);
    ramp.child("stop").number(1).number(std::min(most, thickest) / thickest);
}

// There α along the tangent is mix(α, 1, s²), and across it α. Here their ratio is 1 - anisotropy, and the mean of
// their squares that of the roughness.
void GltfSurface::writeAnisotropy(SceneNode& node) {
    const GltfObject stretched = extension("KHR_materials_anisotropy");
    const double strength = stretched.share("anisotropyStrength", 0),
                 rotation = stretched.number("anisotropyRotation", 0);
    const GltfTextureUse map = texture(stretched.texture("anisotropyTexture"), "anisotropyTexture");
    stretched.warnOfUnused();
    if (strength == 0) return;
    const bool varies = roughnessTexture_ || map;
    const bool isClear = extension("KHR_materials_transmission").number("transmissionFactor", 0) > 0;
    if (isClear && varies)
        return ctx_.import.leftOut(&node, span_, stretched.where(), "stretched rough glass cannot vary by a texture");
    if (varies)
        ctx_.import.approximated(&node, span_, stretched.where(),
                                 "where a texture varies the roughness, that of its factor counts for the stretch");
    const double across = std::max(roughness_ * roughness_, 1e-4), along = across + (1 - across) * strength * strength,
                 anisotropy = 1 - across / along;
    if (map) {
        writeNumber(node, "specular-roughness-anisotropy", anisotropy, map, "blue", 0);
        if (rotation == 0) return textures_.write(node.child("geometry-tangent"), map, GltfTexels::data);
        ctx_.import.leftOut(&node, span_, fmt::format("the directions of {}", map.where), "anisotropyRotation counts");
    } else {
        node.child("specular-roughness-anisotropy").number(anisotropy);
    }
    if (!roughnessTexture_) roughness_ = std::pow((along * along + across * across) / 2, 0.25);
    const double turns = rotation / (2 * kPiD);
    if (rotation != 0) node.child("geometry-tangent").number(turns - std::round(turns));
}

} // namespace abbe::exchange
