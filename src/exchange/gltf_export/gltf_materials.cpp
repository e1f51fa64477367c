#include "exchange/gltf_export/gltf_writer.h"
#include "exchange/stated/stated_spectra.h"
#include "io/file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

struct GltfLook {
    GltfJson json, pbr;
    GltfWriter& w;

    GltfJson& extension(const char* name) {
        w.extensions.insert(name);
        return json["extensions"][name];
    }
};

GltfJson colorOf(Vec3d rgb) { return {std::min(1.0, rgb.x), std::min(1.0, rgb.y), std::min(1.0, rgb.z)}; }

// The index of the texture of an image that glTF has, which is PNG or JPEG, inside of the file.
std::optional<std::size_t> gltfTexture(const StatedThing& texture, GltfWriter& w) {
    const auto* const file = texture.type == "image" ? texture.value<schema::Text>("file") : nullptr;
    std::string ending = file ? std::filesystem::path(file->value).extension().string() : std::string();
    std::ranges::transform(ending, ending.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    const bool png = ending == ".png", jpeg = ending == ".jpg" || ending == ".jpeg";
    if (!png && !jpeg) {
        w.out.leftOut(texture.span, fmt::format("texture `{}`", texture.type),
                      "glTF has images in PNG and JPEG; grey stands for it");
        return std::nullopt;
    }
    const auto [at, fresh] = w.images.emplace(file->value, 0);
    if (fresh) {
        const std::size_t view = w.addView(readFileBytes(file->value));
        const std::size_t image =
            w.add("images", {{"bufferView", view}, {"mimeType", png ? "image/png" : "image/jpeg"}});
        const std::string wrap = texture.word("wrap");
        constexpr int kRepeat = 10497, kClamp = 33071, kMirror = 33648;
        const int mode = wrap == "clamp" ? kClamp : wrap == "mirror" ? kMirror : kRepeat;
        const std::size_t sampler = w.add("samplers", {{"wrapS", mode}, {"wrapT", mode}});
        at->second = w.add("textures", {{"source", image}, {"sampler", sampler}});
    }
    return at->second;
}

void baseColor(GltfLook& look, const StatedThing& m, const char* property, double otherwise) {
    const StatedSpectrum s = m.spectrum(property);
    Vec3d rgb(otherwise, otherwise, otherwise);
    if (s.curve) rgb = rgbOf(*s.curve, look.w.out.scene.daylight());
    if (s.texture) {
        rgb = {0.5, 0.5, 0.5};
        if (const auto texture = gltfTexture(*s.texture, look.w)) {
            rgb = {1, 1, 1};
            look.pbr["baseColorTexture"] = {{"index", *texture}};
        }
    }
    const double opacity = m.textured("opacity", 1).value;
    look.pbr["baseColorFactor"] = {std::min(1.0, rgb.x), std::min(1.0, rgb.y), std::min(1.0, rgb.z), opacity};
    if (opacity < 1) look.json["alphaMode"] = "BLEND";
}

// Roughness is the root of α in both.
double roughnessOf(const StatedThing& m, const char* property, double otherwise, GltfWriter& w) {
    const StatedNumber r = m.textured(property, otherwise);
    if (r.texture) w.out.approximated(m.span, fmt::format("the texture of `{}`", property), "by 0.3 everywhere");
    return r.texture ? 0.3 : r.value;
}

double indexOf(const StatedThing& m, const char* property, double otherwise) {
    const StatedSpectrum ior = m.spectrum(property);
    return ior.curve ? indexAtD(*ior.curve) : otherwise;
}

Vec3d reflectedColor(const Curve& curve, GltfWriter& w) {
    schema::SpectrumValue stated;
    stated.form = schema::SpectrumValue::Form::table;
    return rgbOf(StatedCurve(stated, schema::SpectrumRole::albedo, curve), w.out.scene.daylight());
}

// What a metal reflects of light that comes straight on, as a colour.
Vec3d metalColor(const StatedThing& m, const char* property, GltfWriter& w) {
    const auto* const index = m.value<schema::ComplexIndex>(property);
    if (!index) return {0.8, 0.8, 0.8};
    return reflectedColor(SampledCurve([&](double nm) {
                              const double n = index->n->at(nm), k = index->k->at(nm);
                              return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
                          }),
                          w);
}

void lookOf(GltfLook& look, const StatedThing& m, int depth);

void metalLook(GltfLook& look, const StatedThing& m) {
    const Vec3d c = metalColor(m, "index", look.w);
    look.pbr["baseColorFactor"] = {c.x, c.y, c.z, m.textured("opacity", 1).value};
    look.pbr["metallicFactor"] = 1;
    look.pbr["roughnessFactor"] = roughnessOf(m, "roughness", 0, look.w);
}

void glassLook(GltfLook& look, const StatedThing& m, bool thin) {
    look.pbr["baseColorFactor"] = {1, 1, 1, m.textured("opacity", 1).value};
    look.pbr["metallicFactor"] = 0;
    look.pbr["roughnessFactor"] = thin ? 0 : roughnessOf(m, "roughness", 0, look.w);
    look.extension("KHR_materials_transmission")["transmissionFactor"] = 1;
    look.extension("KHR_materials_ior")["ior"] = indexOf(m, "ior", 1.5);
    if (thin) return;
    GltfJson& volume = look.extension("KHR_materials_volume");
    volume["thicknessFactor"] = 1;
    if (const StatedSpectrum color = m.spectrum("attenuation-color"); color.curve) {
        volume["attenuationColor"] = colorOf(rgbOf(*color.curve, look.w.out.scene.daylight()));
        volume["attenuationDistance"] = m.number("attenuation-distance", 1);
    } else if (const StatedCurve* sigma = m.spectrum("absorption").curve; sigma && sigma->maximum() > 0) {
        // What is left after the mean free path in the middle of the spectrum, or the shortest.
        const double distance = 1 / (sigma->at(550) > 0 ? sigma->at(550) : sigma->maximum());
        const SampledCurve left([&](double nm) { return std::exp(-sigma->at(nm) * distance); });
        volume["attenuationColor"] = colorOf(reflectedColor(left, look.w));
        volume["attenuationDistance"] = rounded(distance);
    }
}

void openPbrLook(GltfLook& look, const StatedThing& m) {
    baseColor(look, m, "base-color", 0.8);
    look.pbr["metallicFactor"] = m.textured("base-metalness", 0).value;
    look.pbr["roughnessFactor"] = roughnessOf(m, "specular-roughness", 0.3, look.w);
    look.extension("KHR_materials_ior")["ior"] = indexOf(m, "specular-ior", 1.5);
    if (const double share = m.textured("transmission-weight", 0).value; share > 0)
        look.extension("KHR_materials_transmission")["transmissionFactor"] = share;
    if (const double coat = m.textured("coat-weight", 0).value; coat > 0) {
        GltfJson& clear = look.extension("KHR_materials_clearcoat");
        clear["clearcoatFactor"] = coat;
        clear["clearcoatRoughnessFactor"] = m.textured("coat-roughness", 0).value;
    }
    look.w.out.approximated(m.span, "`openpbr`", "glTF has some of its lobes");
}

void coatLook(GltfLook& look, const StatedThing& m, int depth) {
    if (const StatedThing* base = m.reference("base")) lookOf(look, *base, depth + 1);
    GltfJson& coat = look.extension("KHR_materials_clearcoat");
    coat["clearcoatFactor"] = 1;
    coat["clearcoatRoughnessFactor"] = roughnessOf(m, "roughness", 0, look.w);
    look.w.out.approximated(m.span, "`layered`", "glTF's clear coat has an index of 1.5 and absorbs nothing");
    Export::ignore(m, {"ior"});
}

void matteLook(GltfLook& look, const StatedThing& m, const char* property) {
    baseColor(look, m, property, 0.5);
    look.pbr["metallicFactor"] = 0;
    look.pbr["roughnessFactor"] = 1;
    // Without the gloss that glTF puts on everything.
    look.extension("KHR_materials_specular")["specularFactor"] = 0;
}

void lookOf(GltfLook& look, const StatedThing& m, int depth) {
    constexpr int kDeepest = 16;
    const auto part = [&](const char* property) {
        const StatedThing* const inner = depth < kDeepest ? m.reference(property) : nullptr;
        if (inner) lookOf(look, *inner, depth + 1);
    };
    if (m.type == "conductor") return metalLook(look, m);
    if (m.type == "dielectric" || m.type == "thin-dielectric") return glassLook(look, m, m.type != "dielectric");
    if (m.type == "openpbr") return openPbrLook(look, m);
    if (m.type == "layered") return coatLook(look, m, depth);
    if (m.type == "diffuse") return matteLook(look, m, "reflectance");
    if (m.type == "mix" || m.type == "two-sided") {
        look.w.out.approximated(m.span, fmt::format("`{}`", m.type), "glTF has one surface: the first");
        Export::ignore(m, {"amount", "second", "back"});
        return part(m.type == "mix" ? "first" : "front");
    }
    look.w.out.approximated(m.span, fmt::format("`{}`", m.type), "by a matte surface of its colour");
    matteLook(look, m, m.type == "sheen" ? "base-color" : m.type == "hair" ? "color" : "reflectance");
    for (const auto& unused : m.takeUnused()) m.has(unused.property);
}

} // namespace

std::size_t gltfMaterial(const StatedThing& material, GltfWriter& w) {
    if (const auto found = w.materials.find(&material); found != w.materials.end()) return found->second;
    GltfLook look{{}, {}, w};
    if (!material.name.empty()) look.json["name"] = material.name;
    lookOf(look, material, 0);
    look.json["pbrMetallicRoughness"] = look.pbr;
    look.json["doubleSided"] = true;
    if (const StatedThing* normal = normalMapOf(material, w.out))
        if (const auto texture = gltfTexture(*normal, w)) look.json["normalTexture"] = {{"index", *texture}};
    Export::ignore(material, {"priority"});
    w.out.leaveOutUnused(material);
    return w.materials[&material] = w.add("materials", look.json);
}

std::size_t gltfLamp(const StatedThing& thing, Vec3d nits, GltfWriter& w) {
    const double most = std::max(1e-30, maxComponent(nits));
    w.extensions.insert("KHR_materials_emissive_strength");
    GltfJson json;
    if (!thing.name.empty()) json["name"] = thing.name;
    json["pbrMetallicRoughness"] = {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    json["emissiveFactor"] = colorOf(nits / most);
    json["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = rounded(most);
    return w.add("materials", json);
}

} // namespace abbe::exchange
