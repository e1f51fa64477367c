// Materials: OpenPBR of MaterialX in UsdShade, and a UsdPreviewSurface beside it for programs that lack MaterialX.
#include "exchange/usd_export/usd_look.h"
#include "io/file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

struct UsdParameter {
    std::string_view ours, theirs;
    enum class Kind : std::uint8_t { number, color, length } kind;
};
using UsdKind = UsdParameter::Kind;

// Those of OpenPBR that are the same in both, in its order.
constexpr UsdParameter kOpenPbr[] = {
    {"base-weight", "base_weight", UsdKind::number},
    {"base-color", "base_color", UsdKind::color},
    {"base-diffuse-roughness", "base_diffuse_roughness", UsdKind::number},
    {"base-metalness", "base_metalness", UsdKind::number},
    {"specular-weight", "specular_weight", UsdKind::number},
    {"specular-color", "specular_color", UsdKind::color},
    {"specular-roughness", "specular_roughness", UsdKind::number},
    {"specular-roughness-anisotropy", "specular_roughness_anisotropy", UsdKind::number},
    {"transmission-weight", "transmission_weight", UsdKind::number},
    {"transmission-color", "transmission_color", UsdKind::color},
    {"transmission-depth", "transmission_depth", UsdKind::length},
    {"transmission-scatter", "transmission_scatter", UsdKind::color},
    {"transmission-scatter-anisotropy", "transmission_scatter_anisotropy", UsdKind::number},
    {"transmission-dispersion-scale", "transmission_dispersion_scale", UsdKind::number},
    {"transmission-dispersion-abbe-number", "transmission_dispersion_abbe_number", UsdKind::number},
    {"subsurface-weight", "subsurface_weight", UsdKind::number},
    {"subsurface-color", "subsurface_color", UsdKind::color},
    {"subsurface-radius", "subsurface_radius", UsdKind::length},
    {"subsurface-radius-scale", "subsurface_radius_scale", UsdKind::color},
    {"subsurface-scatter-anisotropy", "subsurface_scatter_anisotropy", UsdKind::number},
    {"coat-weight", "coat_weight", UsdKind::number},
    {"coat-color", "coat_color", UsdKind::color},
    {"coat-roughness", "coat_roughness", UsdKind::number},
    {"coat-roughness-anisotropy", "coat_roughness_anisotropy", UsdKind::number},
    {"coat-darkening", "coat_darkening", UsdKind::number},
    {"fuzz-weight", "fuzz_weight", UsdKind::number},
    {"fuzz-color", "fuzz_color", UsdKind::color},
    {"fuzz-roughness", "fuzz_roughness", UsdKind::number},
    {"thin-film-weight", "thin_film_weight", UsdKind::number},
};

void openPbr(UsdLook& look, const StatedThing& m) {
    for (const UsdParameter& p : kOpenPbr) {
        if (!m.has(p.ours)) continue;
        if (p.kind == UsdKind::color)
            look.color(p.theirs, m.spectrum(p.ours));
        else
            look.number(p.theirs, m.textured(p.ours, 0));
    }
    // A millimetre is its default here, a unit of the scene there.
    if (!m.has("subsurface-radius") && m.has("subsurface-weight")) look.constant("subsurface_radius", 0.001);
    for (const auto& [ours, theirs] :
         {std::pair{"specular-ior", "specular_ior"}, {"coat-ior", "coat_ior"}, {"thin-film-ior", "thin_film_ior"}})
        if (m.has(ours)) look.index(theirs, m, ours);
    if (m.has("thin-film-thickness")) // in µm there
        look.number("thin_film_thickness", {m.textured("thin-film-thickness", 5e-7).value * 1e6,
                                            m.textured("thin-film-thickness", 0).texture});
    if (m.word("geometry-thin-walled") == "on") look.flag("geometry_thin_walled");
    if (m.has("emission-luminance")) {
        look.constant("emission_luminance", m.number("emission-luminance", 0));
        if (const StatedSpectrum tint = m.spectrum("emission-color"); tint) look.emissionColor(tint);
    }
    if (m.has("base-metal-index")) {
        const Vec3d rgb = look.metalColor(m, "base-metal-index");
        look.constant("base_color", rgb);
        look.w.out.approximated(m.span, "`base-metal-index`", "by the colour that the metal reflects");
    }
}

void diffuse(UsdLook& look, const StatedThing& m, const char* property) {
    look.constant("specular_weight", 0);
    look.color("base_color", m.spectrum(property));
    if (!m.spectrum(property)) look.constant("base_color", Vec3d(0.5, 0.5, 0.5));
}

void grey(UsdLook& look) {
    look.constant("specular_weight", 0);
    look.constant("base_color", Vec3d(0.5, 0.5, 0.5));
}

void conductor(UsdLook& look, const StatedThing& m) {
    look.constant("base_metalness", 1);
    Vec3d rgb = look.metalColor(m, "index");
    if (const StatedSpectrum tint = m.spectrum("tint"); tint.curve)
        rgb = eachTimes(rgb, rgbOf(*tint.curve, look.w.out.scene.daylight()));
    look.constant("base_color", rgb);
    look.number("specular_roughness", m.textured("roughness", 0));
    look.number("specular_roughness_anisotropy", m.textured("anisotropy", 0));
    look.w.out.approximated(m.span, "`conductor`",
                            "by the colour that the metal reflects: metals of OpenPBR have no index");
}

void dielectric(UsdLook& look, const StatedThing& m, bool thin) {
    look.constant("transmission_weight", 1);
    look.index("specular_ior", m, "ior");
    if (thin) {
        look.constant("specular_roughness", 0);
        look.flag("geometry_thin_walled");
        look.color("transmission_color", m.spectrum("tint"));
        return;
    }
    look.number("specular_roughness", m.textured("roughness", 0));
    if (const StatedSpectrum color = m.spectrum("attenuation-color"); color.curve) {
        look.color("transmission_color", color);
        look.constant("transmission_depth", m.number("attenuation-distance", 1));
    } else if (const StatedCurve* sigma = m.spectrum("absorption").curve; sigma && sigma->maximum() > 0) {
        // What is left after the mean free path in the middle of the spectrum, or the shortest.
        const double distance = 1 / (sigma->at(550) > 0 ? sigma->at(550) : sigma->maximum());
        look.constant("transmission_color",
                      look.reflected([&](double nm) { return std::exp(-sigma->at(nm) * distance); }));
        look.constant("transmission_depth", rounded(distance));
    }
}

// Light that wanders below the surface.
void subsurface(UsdLook& look, const StatedThing& m) {
    look.constant("subsurface_weight", 1);
    look.color("subsurface_color", m.spectrum("reflectance"));
    const StatedSpectrum path = m.spectrum("mean-free-path");
    const double plain = m.number("mean-free-path", 0.001);
    const Vec3d rgb = path.curve ? rgbOf(*path.curve, look.w.out.scene.daylight()) : Vec3d(plain, plain, plain);
    look.constant("subsurface_radius", rounded(maxComponent(rgb)));
    look.constant("subsurface_radius_scale", rgb / maxComponent(rgb));
    if (m.has("anisotropy")) look.constant("subsurface_scatter_anisotropy", m.number("anisotropy", 0));
    look.index("specular_ior", m, "ior", 1.4);
    look.number("specular_roughness", m.textured("roughness", 0.3));
    Export::ignore(m, {"boundary"});
    look.w.out.approximated(m.span, "`subsurface`",
                            "by the subsurface of OpenPBR, which light enters as its writer chooses");
}

// A thin sheet, whose light OpenPBR parts by one number: what is sent back of all has (1 - g) / 2 [Andersson2024].
void diffuseTransmission(UsdLook& look, const StatedThing& m) {
    const StatedSpectrum back = m.spectrum("reflectance"), through = m.spectrum("transmittance");
    const auto rgb = [&](const StatedSpectrum& s) {
        return s.curve ? rgbOf(*s.curve, look.w.out.scene.daylight()) : Vec3d(0.25, 0.25, 0.25);
    };
    const Vec3d r = rgb(back), t = rgb(through), all = r + t;
    const double sum = all.x + all.y + all.z, g = sum > 0 ? (t.x + t.y + t.z - r.x - r.y - r.z) / sum : 0;
    look.flag("geometry_thin_walled");
    look.constant("specular_weight", 0);
    look.constant("subsurface_weight", 1);
    look.constant("subsurface_color", Vec3d(rounded(all.x), rounded(all.y), rounded(all.z)));
    look.constant("subsurface_scatter_anisotropy", rounded(g));
    if (back.texture || through.texture)
        look.w.out.leftOut(m.span, "a texture of `diffuse-transmission`", "OpenPBR has one colour for both sides");
    else if (const Vec3d off = t - all * ((1 + g) / 2); length(off) > 1e-6)
        look.w.out.approximated(m.span, "`diffuse-transmission`", "in OpenPBR both sides have one colour");
}

void write(UsdLook& look, const StatedThing& m, int depth) {
    constexpr int kMostLayers = 16;
    const auto part = [&](const char* property) {
        if (const StatedThing* inner = depth < kMostLayers ? m.reference(property) : nullptr)
            write(look, *inner, depth + 1);
    };
    if (m.type == "subsurface") return subsurface(look, m);
    if (m.type == "diffuse-transmission") return diffuseTransmission(look, m);
    if (m.type == "openpbr") return openPbr(look, m);
    if (m.type == "diffuse") return diffuse(look, m, "reflectance");
    if (m.type == "conductor") return conductor(look, m);
    if (m.type == "dielectric" || m.type == "thin-dielectric") return dielectric(look, m, m.type != "dielectric");
    if (m.type == "layered") {
        part("base");
        look.constant("coat_weight", 1);
        look.index("coat_ior", m, "ior", 1.5);
        look.number("coat_roughness", m.textured("roughness", 0));
        look.color("coat_color", m.spectrum("tint"));
        look.constant("coat_darkening", m.number("darkening", 1));
        look.w.out.approximated(m.span, "`layered`", "by the coat of OpenPBR");
        return;
    }
    if (m.type == "mix" || m.type == "two-sided") {
        look.w.out.approximated(m.span, fmt::format("`{}`", m.type), "OpenPBR is one surface: the first");
        Export::ignore(m, {"amount", "second", "back"});
        return part(m.type == "mix" ? "first" : "front");
    }
    if (m.type == "sheen") {
        look.constant("fuzz_weight", 1);
        look.color("fuzz_color", m.spectrum("color"));
        look.number("fuzz_roughness", m.textured("roughness", 0.3));
        look.w.out.approximated(m.span, "`sheen`", "by the fuzz of OpenPBR");
        return diffuse(look, m, "base-color");
    }
    look.w.out.approximated(m.span, fmt::format("`{}`", m.type), "by a matte surface of its colour");
    diffuse(look, m, m.type == "hair" ? "color" : "reflectance");
    for (const auto& unused : m.takeUnused()) m.has(unused.property);
}

} // namespace

void usdWriteSurface(UsdLook& look, const StatedThing& material) { write(look, material, 0); }

std::string usdMaterial(const UsdDress& dress, UsdWriter& w) {
    if (dress == UsdDress()) return {};
    if (const auto found = w.materials.find(dress); found != w.materials.end()) return found->second;
    const StatedThing* const material = dress.material;
    std::string name = material ? material->name : "";
    const StatedThing* const made = dress.displaced ? dress.displaced : material ? nullptr : dress.interior;
    if (made && !made->name.empty()) name = (name.empty() ? "material" : name) + "_" + made->name;
    UsdLook look(w.take(name, !material || material->type.empty() ? "material" : material->type), w);
    if (dress.interior)
        usdFill(look, material, *dress.interior);
    else if (material)
        write(look, *material, 0);
    else
        grey(look);
    if (dress.displaced) look.displacement(*dress.displaced);
    if (material) {
        if (material->has("opacity")) look.number("geometry_opacity", material->textured("opacity", 1));
        if (const auto* normal = material->value<schema::WeightedReference>("normal"))
            look.normal(w.out.scene.thing(normal->reference), normal->weight);
        Export::ignore(*material, {"priority"});
        w.out.leaveOutUnused(*material);
    }
    const std::string path = look.path();
    UsdPrim prim = look.take();
    w.looks.add(std::move(w.withRemarks(prim)));
    return w.materials[dress] = path;
}

std::string usdGlow(const UsdGlowing& glow, UsdWriter& w) {
    const StatedThing& texture = *glow.texture;
    UsdLook look(w.take(texture.name.empty() ? "" : texture.name + "_light", "light_texture"), w);
    const StatedThing* const material = glow.shape ? glow.shape->reference("material") : nullptr;
    if (glow.shape && (!material || material->type == "diffuse")) {
        if (material)
            diffuse(look, *material, "reflectance");
        else
            grey(look);
    } else {
        look.constant("base_weight", 0);
        look.constant("specular_weight", 0);
        if (material)
            w.out.approximated(glow.shape->span, "the material of a shape that shows a texture as light",
                               "it is black");
    }
    look.emission(texture, glow.nits, glow.color);
    std::string path = look.path();
    UsdPrim prim = look.take();
    w.looks.add(std::move(w.withRemarks(prim)));
    return path;
}

void usdBind(UsdPrim& prim, const std::string& material) {
    if (material.empty()) return;
    prim.api("MaterialBindingAPI").set("rel material:binding", fmt::format("<{}>", material));
}

} // namespace abbe::exchange
