#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/shared/scene_node.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr double kSmoothAlpha = 0.0005; // α below which a surface is rendered as polished

using MaterialWriter = void (*)(pugi::xml_node parent, std::string_view id, const StatedThing&, MitsubaWriter&);

void writeInner(pugi::xml_node parent, std::string_view id, const StatedThing&, bool blackBehind, MitsubaWriter&);

// The square root of α is `roughness` here. Textures of roughness would have to be squared.
double alphaOf(const StatedThing& m, std::string_view property, double otherwise, MitsubaWriter& w) {
    const StatedNumber r = m.textured(property, otherwise);
    if (r.texture)
        w.out.approximated(m.span, fmt::format("the texture of `{}`", property), "by a roughness of 0.3 everywhere");
    const double roughness = r.texture ? 0.3 : r.value;
    return rounded(roughness * roughness);
}

// `alpha`, or two of them: αv = (1 − anisotropy) αu, mean square kept.
void writeAlpha(pugi::xml_node node, double alpha, double anisotropy) {
    xmlValue(node, "string", "distribution", "ggx");
    if (anisotropy == 0) return xmlNumber(node, "alpha", alpha);
    const double u = alpha * std::sqrt(2 / (1 + (1 - anisotropy) * (1 - anisotropy)));
    xmlNumber(node, "alpha_u", rounded(u));
    xmlNumber(node, "alpha_v", rounded((1 - anisotropy) * u));
}

void noteLostLight(const StatedThing& m, double alpha, MitsubaWriter& w) {
    if (alpha > 0.15)
        w.out.approximated(m.span, fmt::format("a rough `{}`", m.type),
                           "Mitsuba loses light between the facets, up to 17 % at grazing angles");
}

// A factor of 1 by default; nothing is written then.
void writeTint(pugi::xml_node node, const char* name, const StatedThing& m, const char* property, MitsubaWriter& w) {
    if (const StatedSpectrum tint = m.spectrum(property)) writeMitsubaColor(node, name, tint, 1, w);
}

void writeReflectance(pugi::xml_node node, const char* name, const StatedThing& m, const char* property,
                      double otherwise, MitsubaWriter& w) {
    if (const StatedSpectrum s = m.spectrum(property))
        writeMitsubaColor(node, name, s, 1, w);
    else
        xmlValue(node, "spectrum", name, numberText(otherwise));
}

void writeDiffuseBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    writeReflectance(xmlChild(parent, "bsdf", "diffuse", {}, id), "reflectance", m, "reflectance", 0.5, w);
}

// Metals that Mitsuba has by the same name.
constexpr std::string_view kMitsubaMetals[] = {"Ag", "Al", "Au", "Cr", "Cu", "Hg", "TiN", "W"};

void writeMetal(pugi::xml_node node, const StatedThing& m, const char* property, MitsubaWriter& w) {
    const auto* const index = m.value<schema::ComplexIndex>(property);
    if (!index) return;
    const auto &n = static_cast<const StatedCurve&>(*index->n), &k = static_cast<const StatedCurve&>(*index->k);
    const bool metal = n.stated.form == schema::SpectrumValue::Form::metal &&
                       k.stated.form == schema::SpectrumValue::Form::metal && n.stated.text == k.stated.text;
    if (metal && std::ranges::find(kMitsubaMetals, n.stated.text) != std::end(kMitsubaMetals)) {
        xmlValue(node, "string", "material", n.stated.text);
        w.out.approximated(m.span, fmt::format("metal `{}`", n.stated.text),
                           "by another measurement of the same metal");
        return;
    }
    if (n.isConstant() && n.at(550) == 0 && k.isConstant() && k.at(550) == 1)
        return xmlValue(node, "string", "material", "none"); // a mirror
    xmlSpectrum(node, "eta", plainSpectrum(n));
    xmlSpectrum(node, "k", plainSpectrum(k));
}

void writeConductorBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    const double alpha = alphaOf(m, "roughness", 0, w);
    const bool rough = alpha >= kSmoothAlpha;
    pugi::xml_node node = xmlChild(parent, "bsdf", rough ? "roughconductor" : "conductor", {}, id);
    writeMetal(node, m, "index", w);
    writeTint(node, "specular_reflectance", m, "tint", w);
    if (rough) writeAlpha(node, alpha, m.textured("anisotropy", 0).value);
    if (rough) noteLostLight(m, alpha, w);
}

// The index of a clear material, one for all wavelengths.
double clearIndex(const StatedThing& m, double otherwise, MitsubaWriter& w) {
    const StatedSpectrum ior = m.spectrum("ior");
    if (!ior.curve) return otherwise;
    if (!ior.curve->isConstant())
        w.out.approximated(m.span, "an index that varies with wavelength", "by that at 589.3 nm: nothing disperses");
    return indexAtD(*ior.curve);
}

void writeDielectricBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    const double alpha = alphaOf(m, "roughness", 0, w);
    const bool rough = alpha >= kSmoothAlpha;
    pugi::xml_node node = xmlChild(parent, "bsdf", rough ? "roughdielectric" : "dielectric", {}, id);
    xmlNumber(node, "int_ior", clearIndex(m, 1.5, w));
    xmlNumber(node, "ext_ior", 1);
    if (rough) writeAlpha(node, alpha, 0);
    if (rough) noteLostLight(m, alpha, w);
    Export::ignore(m, {"absorption", "attenuation-color", "attenuation-distance"}); // a medium of the shape
}

void writeThinBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    pugi::xml_node node = xmlChild(parent, "bsdf", "thindielectric", {}, id);
    xmlNumber(node, "int_ior", clearIndex(m, 1.5, w));
    xmlNumber(node, "ext_ior", 1);
}

void writeMixBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, bool blackBehind,
                  MitsubaWriter& w) {
    pugi::xml_node node = xmlChild(parent, "bsdf", "blendbsdf", {}, id);
    writeMitsubaNumber(node, "weight", m.textured("amount", 0.5), w);
    for (const char* part : {"first", "second"})
        if (const StatedThing* inner = m.reference(part))
            writeInner(node, inner->name.empty() ? "" : w.takeId(inner->name, {}), *inner, blackBehind, w);
    Export::ignore(m, {"priority"});
    w.out.leaveOutUnused(m);
}

// A clear coat over a matte base is plastic; Mitsuba has no coats over others.
void writeLayeredBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    const StatedThing* const base = m.reference("base");
    if (!base || base->type != "diffuse") {
        w.out.leftOut(m.span, "the coat of `layered`", "Mitsuba has coats on matte materials alone");
        Export::ignore(m, {"ior", "roughness", "tint", "absorption", "thickness", "darkening"});
        if (base) writeInner(parent, id, *base, true, w); // both sides are there already, or one is enough
        return;
    }
    const double alpha = alphaOf(m, "roughness", 0, w);
    const bool rough = alpha >= kSmoothAlpha;
    pugi::xml_node node = xmlChild(parent, "bsdf", rough ? "roughplastic" : "plastic", {}, id);
    writeReflectance(node, "diffuse_reflectance", *base, "reflectance", 0.5, w);
    xmlNumber(node, "int_ior", clearIndex(m, 1.5, w));
    xmlNumber(node, "ext_ior", 1);
    xmlFlag(node, "nonlinear", m.textured("darkening", 1).value > 0.5);
    if (rough) writeAlpha(node, alpha, 0);
    w.out.approximated(m.span, "`layered`",
                       "by plastic; how its base depends on the direction of light differs by a few percent");
}

// The principled model [Burley2012] has the same lobes in another order.
void writePrincipledBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    const bool thin = m.word("geometry-thin-walled") == "on";
    pugi::xml_node node = xmlChild(parent, "bsdf", thin ? "principledthin" : "principled", {}, id);
    writeReflectance(node, "base_color", m, "base-color", 0.8, w);
    writeMitsubaNumber(node, "roughness", m.textured("specular-roughness", 0.3), w);
    xmlNumber(node, "eta",
              clearIndex(
                  m, rounded(m.spectrum("specular-ior").curve ? indexAtD(*m.spectrum("specular-ior").curve) : 1.5), w));
    const auto number = [&](const char* name, const char* property) {
        if (m.has(property)) writeMitsubaNumber(node, name, m.textured(property, 0), w);
    };
    if (!thin) number("metallic", "base-metalness");
    number("spec_trans", "transmission-weight");
    number("sheen", "fuzz-weight");
    if (!thin) number("clearcoat", "coat-weight");
    if (const double r = m.textured("coat-roughness", 0).value; !thin && m.has("coat-roughness"))
        xmlNumber(node, "clearcoat_gloss", rounded(std::clamp((0.1 - r * r) / 0.099, 0.0, 1.0)));
    if (m.has("specular-roughness-anisotropy"))
        xmlNumber(node, "anisotropic",
                  rounded(std::min(1.0, m.textured("specular-roughness-anisotropy", 0).value / 0.9)));
    if (thin && m.has("subsurface-weight"))
        xmlNumber(node, "diff_trans", rounded(2 * m.textured("subsurface-weight", 0).value));
    w.out.approximated(m.span, "`openpbr`",
                       "the principled model has the same lobes in another order, and loses light");
}

void writeHairBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    pugi::xml_node node = xmlChild(parent, "bsdf", "hair", {}, id);
    const auto number = [&](const char* name, const char* property) {
        if (m.has(property)) xmlNumber(node, name, m.textured(property, 0).value);
    };
    number("eumelanin", "eumelanin");
    number("pheomelanin", "pheomelanin");
    if (const StatedSpectrum sigma = m.spectrum("absorption"); sigma.curve)
        xmlSpectrum(node, "sigma_a", plainSpectrum(*sigma.curve));
    number("longitudinal_roughness", "longitudinal-roughness");
    number("azimuthal_roughness", "azimuthal-roughness");
    xmlNumber(node, "scale_tilt", rounded(m.number("scale-angle", 2 * kDegree) / kDegree));
    xmlNumber(node, "int_ior", m.number("ior", 1.55));
    xmlNumber(node, "ext_ior", 1);
    w.out.approximated(m.span, "`hair`", "the same model with other constants for pigments");
}

void writeMeasuredBsdf(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    pugi::xml_node node = xmlChild(parent, "bsdf", "measured", {}, id);
    if (const auto* const file = m.value<schema::Text>("file"))
        xmlValue(node, "string", "filename", w.out.files.refer(file->value));
}

void writeNullBsdf(pugi::xml_node parent, std::string_view id, const StatedThing&, MitsubaWriter&) {
    xmlChild(parent, "bsdf", "null", {}, id);
}

// Mitsuba has no such surface: its colour stays.
void writeMatte(pugi::xml_node parent, std::string_view id, const StatedThing& m, MitsubaWriter& w) {
    const bool sheen = m.type == "sheen";
    writeReflectance(xmlChild(parent, "bsdf", "diffuse", {}, id), "reflectance", m,
                     sheen ? "base-color" : "reflectance", 0.5, w);
    w.out.approximated(m.span, fmt::format("`{}`", m.type), "by a matte surface of its colour");
    for (const auto& unused : m.takeUnused()) m.has(unused.property);
}

struct MaterialRow {
    std::string_view type;
    MaterialWriter write;
    bool bothSides; // Mitsuba's is black from behind unless it is made two-sided
};

constexpr MaterialRow kMaterials[] = {
    {"diffuse", writeDiffuseBsdf, true},
    {"conductor", writeConductorBsdf, true},
    {"dielectric", writeDielectricBsdf, false},
    {"thin-dielectric", writeThinBsdf, false},
    {"layered", writeLayeredBsdf, true},
    {"openpbr", writePrincipledBsdf, true},
    {"hair", writeHairBsdf, false},
    {"measured", writeMeasuredBsdf, true},
    {"boundary", writeNullBsdf, false},
    {"subsurface", writeMatte, true},
    {"sheen", writeMatte, true},
    {"diffuse-transmission", writeMatte, true},
};

bool isBlack(const StatedThing* m) {
    if (!m || m->type != "diffuse") return false;
    const StatedSpectrum s = m->spectrum("reflectance");
    return s.curve && s.curve->maximum() == 0;
}

bool isDefaultGrey(const StatedThing& m) {
    const StatedSpectrum s = m.type == "diffuse" ? m.spectrum("reflectance") : StatedSpectrum();
    const bool grey = s.curve && s.curve->isConstant() && s.curve->at(550) == 0.5;
    return m.name.empty() && grey && !m.has("opacity") && !m.has("normal") && !m.has("bump");
}

// mask, bumpmap and normalmap stand around what they change.
pugi::xml_node openModifiers(pugi::xml_node parent, std::string& id, const StatedThing& m, MitsubaWriter& w) {
    const StatedNumber opacity = m.textured("opacity", 1);
    if (opacity.texture || opacity.value != 1) {
        parent = xmlChild(parent, "bsdf", "mask", {}, std::exchange(id, {}));
        writeMitsubaNumber(parent, "opacity", opacity, w);
    }
    if (const StatedThing* map = normalMapOf(m, w.out)) {
        parent = xmlChild(parent, "bsdf", "normalmap", {}, std::exchange(id, {}));
        writeMitsubaTexture(parent, "normalmap", *map, true, w);
    }
    if (const StatedThing* map = m.reference("bump.map")) {
        parent = xmlChild(parent, "bsdf", "bumpmap", {}, std::exchange(id, {}));
        xmlNumber(parent, "scale", m.number("bump", 0));
        writeMitsubaTexture(parent, "texture", *map, true, w);
    }
    m.has("bump");
    return parent;
}

bool isTransparent(const StatedThing& m) {
    return m.type == "openpbr" && (m.has("transmission-weight") || m.word("geometry-thin-walled") == "on");
}

void writeInner(pugi::xml_node parent, std::string_view wish, const StatedThing& m, bool blackBehind,
                MitsubaWriter& w) {
    std::string id(wish);
    parent = openModifiers(parent, id, m, w);
    if (m.type == "two-sided") {
        const StatedThing *const front = m.reference("front"), *const back = m.reference("back");
        if (front && isBlack(back)) return writeInner(parent, id, *front, true, w);
        pugi::xml_node both = xmlChild(parent, "bsdf", "twosided", {}, id);
        for (const StatedThing* side : {front, back})
            if (side) writeInner(both, side->name.empty() ? "" : w.takeId(side->name, {}), *side, true, w);
        return w.out.leaveOutUnused(m);
    }
    if (m.type == "mix") return writeMixBsdf(parent, id, m, blackBehind, w); // its parts have sides
    const auto row = std::ranges::find(kMaterials, std::string_view(m.type), &MaterialRow::type);
    if (row == std::end(kMaterials)) return;
    if (row->bothSides && !blackBehind && !isTransparent(m)) {
        parent = xmlChild(parent, "bsdf", "twosided", {}, id);
        id.clear();
    }
    row->write(parent, id, m, w);
    Export::ignore(m, {"priority"}); // of dielectrics that overlap
    w.out.leaveOutUnused(m);
}

} // namespace

namespace {

// Whether no light gets through to the other side.
bool isOpaque(const StatedThing& m) {
    const auto row = std::ranges::find(kMaterials, std::string_view(m.type), &MaterialRow::type);
    const StatedNumber opacity = m.textured("opacity", 1);
    if (row == std::end(kMaterials) || !row->bothSides || isTransparent(m)) return false;
    if (opacity.texture || opacity.value != 1) return false;
    const StatedThing* const base = m.type == "layered" ? m.reference("base") : nullptr;
    return !base || isOpaque(*base);
}

} // namespace

void writeMitsubaMaterial(pugi::xml_node shape, const StatedThing* material, bool outsideAlone, MitsubaWriter& w) {
    if (!material) { // grey and matte, on both sides
        pugi::xml_node parent = outsideAlone ? shape : xmlChild(shape, "bsdf", "twosided");
        return xmlValue(xmlChild(parent, "bsdf", "diffuse"), "spectrum", "reflectance", "0.5");
    }
    // A two-sided one that is black behind is the front alone, by the front's name.
    const StatedThing* const front = material->type == "two-sided" && material->name.empty() &&
                                             isBlack(material->reference("back")) && !material->has("opacity")
                                         ? material->reference("front")
                                         : nullptr;
    const StatedThing& named = front ? *front : *material;
    const bool blackBehind = front || (outsideAlone && isOpaque(named));
    if (blackBehind && isDefaultGrey(named)) return; // what a shape has there without any
    if (named.name.empty()) return writeInner(shape, {}, named, blackBehind, w);
    std::string& id = (blackBehind ? w.oneSided : w.materials)[&named];
    if (id.empty()) {
        id = w.takeId(named.name, {});
        const pugi::xml_node last = w.root.last_child();
        writeInner(w.root, id, named, blackBehind, w);
        w.remark(last ? last.next_sibling() : w.root.first_child());
    }
    shape.append_child("ref").append_attribute("id") = id.c_str();
}

} // namespace abbe::exchange
