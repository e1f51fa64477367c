#include "exchange/mitsuba/bsdfs.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kMostNestedBsdfs = 64;

double rootOf(double alpha) { return std::sqrt(std::clamp(alpha, 0.0, 1.0)); }

// A factor that the material has no place for.
void needOne(const XmlObject& bsdf, std::string_view param, MitsubaContext& ctx) {
    const XmlParam* const found = bsdf.find(param);
    if (!found) return;
    const bool one = std::ranges::all_of(found->numbers, [](double v) { return v == 1; }) && !found->numbers.empty();
    if (!one)
        ctx.import.leftOut(nullptr, found->span, fmt::format("`{}` of `{}`", param, bsdf.plugin),
                           "this material has no factor of the kind");
}

void noteDistribution(const XmlObject& bsdf, SceneNode& at, MitsubaContext& ctx) {
    const std::string distribution = mitsubaText(bsdf, "distribution", "beckmann");
    mitsubaIgnore(bsdf, {"sample_visible"});
    if (distribution != "ggx")
        ctx.import.approximated(&at, bsdf.span, fmt::format("distribution `{}`", distribution),
                                "by GGX of the same alpha, whose highlights have longer tails");
}

// Light that is scattered more than once between facets is lost there. At alpha 0.15 that is two percent.
void noteLoss(const XmlObject& bsdf, SceneNode& at, MitsubaContext& ctx) {
    constexpr double kMuch = 0.15;
    const auto isRough = [&](std::string_view name) {
        const auto param = std::ranges::find(bsdf.params, name, &XmlParam::name);
        return param != bsdf.params.end() && (param->numbers.empty() || param->numbers[0] > kMuch);
    };
    if (isRough("alpha") || isRough("alpha_u") || isRough("alpha_v"))
        ctx.import.approximated(&at, bsdf.span, fmt::format("`{}`", bsdf.plugin),
                                "this rough it loses light between its facets in Mitsuba, and none here");
}

void writeDiffuse(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    at.word("diffuse");
    writeColor(at, "reflectance", bsdf, "reflectance", SpectrumUse::reflectance, 0.5, traits, ctx);
    traits.oneSided = true;
}

// Rough metal whose highlight is stretched along v needs a tangent that turns: OpenPBR has one.
void writeConductor(SceneNode& at, const XmlObject& bsdf, bool rough, MaterialTraits& traits, MitsubaContext& ctx) {
    traits.oneSided = true;
    at.word("conductor");
    writeMetalIndex(at, "index", bsdf, ctx);
    writeColor(at, "tint", bsdf, "specular_reflectance", SpectrumUse::reflectance, std::nullopt, traits, ctx);
    if (!rough) return;
    if (writeRoughness(at, bsdf, "", traits, ctx))
        ctx.import.approximated(&at, bsdf.span, "`alpha_v` above `alpha_u`",
                                "the highlight is stretched along u, not along v");
    noteDistribution(bsdf, at, ctx);
    noteLoss(bsdf, at, ctx);
}

void writeDielectric(SceneNode& at, const XmlObject& bsdf, bool rough, MaterialTraits& traits, MitsubaContext& ctx) {
    at.word("dielectric");
    at.child("ior").number(relativeIndex(bsdf, 1.5046, ctx));
    needOne(bsdf, "specular_reflectance", ctx);
    needOne(bsdf, "specular_transmittance", ctx);
    traits.clear = true;
    if (!rough) return;
    if (writeRoughness(at, bsdf, "", traits, ctx))
        ctx.import.approximated(&at, bsdf.span, "`alpha_u` and `alpha_v`", "glass is as rough along u as along v here");
    noteDistribution(bsdf, at, ctx);
    noteLoss(bsdf, at, ctx);
}

void writeThinDielectric(SceneNode& at, const XmlObject& bsdf, MitsubaContext& ctx) {
    at.word("thin-dielectric");
    at.child("ior").number(std::max(1.0, relativeIndex(bsdf, 1.5046, ctx)));
    needOne(bsdf, "specular_reflectance", ctx);
    needOne(bsdf, "specular_transmittance", ctx);
}

// Share of diffuse light inside that a smooth boundary throws back: 1 − (1 − R) / η², with R the mean of Fresnel's
// reflectance over the cosine outside.
double internalReflectance(double eta) {
    double sum = 0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
        const double x = (i + 0.5) / kSteps; // cos²
        const double c = std::sqrt(x), t = std::sqrt(1 - (1 - x) / (eta * eta));
        const double s = (c - eta * t) / (c + eta * t), p = (t - eta * c) / (t + eta * c);
        sum += (s * s + p * p) / 2;
    }
    return 1 - (1 - sum / kSteps) / (eta * eta);
}

// The matte base. A nonlinear plastic of even colour darkens by (1 − f)/(1 − f ρ), which its colour takes in; returns
// whether it has all the darkening that there is, and the coat adds none.
bool writePlasticBase(SceneNode& base, const XmlObject& bsdf, std::optional<double> nonlinearIor,
                      MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlParam* const color = bsdf.find("diffuse_reflectance");
    if (!nonlinearIor || (color && isTexture(*color))) {
        writeColor(base, "reflectance", bsdf, "diffuse_reflectance", SpectrumUse::reflectance, 0.5, traits, ctx);
        return !nonlinearIor;
    }
    const double f = internalReflectance(*nonlinearIor);
    const auto darker = [&](double rho) { return rho * (1 - f) / (1 - f * std::clamp(rho, 0.0, 1.0)); };
    std::optional<MitsubaSpectrum> s;
    if (color) s = readSpectrum(*color, SpectrumUse::reflectance, ctx);
    if (!s) {
        s.emplace();
        s->value = 0.5;
    }
    s->value = darker(s->value);
    s->rgb = {darker(s->rgb.x), darker(s->rgb.y), darker(s->rgb.z)};
    for (auto& row : s->rows) row.second = darker(row.second);
    writeSpectrum(base.child("reflectance"), *s, SpectrumUse::reflectance, bsdf.span, ctx);
    return true;
}

// Light between coat and base is lost by Mitsuba's linear plastic as if the base were white, so its base is not
// darkened [Mitsuba 3 documentation, "Smooth plastic material"].
void writePlastic(SceneNode& at, const XmlObject& bsdf, bool rough, MaterialTraits& traits, MitsubaContext& ctx) {
    traits.oneSided = true;
    at.word("layered");
    SceneNode& base = at.child("base").word("diffuse");
    const double ior = std::clamp(relativeIndex(bsdf, 1.49, ctx), 1.0, 4.0);
    const bool nonlinear = mitsubaFlag(bsdf, "nonlinear", false, ctx.import);
    const bool darkened = writePlasticBase(base, bsdf, nonlinear ? std::optional(ior) : std::nullopt, traits, ctx);
    at.child("ior").number(ior);
    if (darkened) at.child("darkening").number(0);
    needOne(bsdf, "specular_reflectance", ctx);
    ctx.import.approximated(
        &at, bsdf.span, fmt::format("`{}`", bsdf.plugin),
        "a clear coat over a matte base; how the base depends on the direction of light differs by a few percent");
    if (!rough) return;
    writeNumber(at, "roughness", bsdf, "alpha", 0.1, rootOf, traits, ctx);
    noteDistribution(bsdf, at, ctx);
}

// The nested BSDF by a name.
void writeNamed(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx);

// The nested BSDF, by the name of its own or in place.
void writeNested(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    if (bsdf.id.empty())
        writeMaterial(at, bsdf, traits, ctx);
    else
        writeNamed(at, bsdf, traits, ctx);
}

void writeNamed(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    const auto& [name, inner] = materialOf(bsdf, ctx);
    at.name(name);
    traits.oneSided = traits.oneSided || inner.oneSided;
    traits.framed = traits.framed || inner.framed;
    traits.normalMap = traits.normalMap || inner.normalMap;
    traits.clear = traits.clear || inner.clear;
    if (!inner.textured) return;
    if (traits.textured && traits.toUv.has_value() != inner.toUv.has_value())
        ctx.import.approximated(nullptr, bsdf.span, "`to_uv`",
                                "the textures of a material share one; that of the first is used");
    else if (!traits.textured)
        traits.toUv = inner.toUv;
    traits.textured = true;
}

const XmlObject* nestedBsdf(const XmlObject& bsdf, std::size_t number, MitsubaContext& ctx) {
    const auto list = bsdf.objects("bsdf");
    if (number < list.size()) return list[number];
    ctx.import.diagnostics.error("E0802", bsdf.span, fmt::format("`{}` lacks a BSDF inside of it", bsdf.plugin));
    return nullptr;
}

void writeTwoSided(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    const auto list = bsdf.objects("bsdf");
    const XmlObject* const front = nestedBsdf(bsdf, 0, ctx);
    if (!front) {
        at.word("diffuse");
        return;
    }
    const bool hasBothSides =
        front->plugin == "diffuse" || front->plugin == "conductor" || front->plugin == "roughconductor";
    if (list.size() < 2 && hasBothSides)
        writeMaterial(at, *front, traits, ctx);
    else {
        at.word("two-sided");
        if (list.size() > 1)
            writeNested(at.child("front"), *front, traits, ctx);
        else // once and by name: nested ones would double at every level
            writeNamed(at.child("front"), *front, traits, ctx);
        if (list.size() > 1)
            writeNested(at.child("back"), *list[1], traits, ctx);
        else
            writeNamed(at.child("back"), *front, traits, ctx);
    }
    traits.oneSided = false;
}

void writeBlend(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlObject *const first = nestedBsdf(bsdf, 0, ctx), *const second = first ? nestedBsdf(bsdf, 1, ctx) : nullptr;
    if (!second) {
        at.word("diffuse");
        return;
    }
    at.word("mix");
    writeNested(at.child("first"), *first, traits, ctx);
    writeNested(at.child("second"), *second, traits, ctx);
    writeNumber(at, "amount", bsdf, "weight", 0.5, nullptr, traits, ctx);
}

// mask, bumpmap, normalmap: a property of the BSDF inside.
void writeWrapper(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    SceneNode inside("front");
    if (const XmlObject* const inner = nestedBsdf(bsdf, 0, ctx))
        writeMaterial(inside, *inner, traits, ctx);
    else
        inside.word("diffuse");
    if (bsdf.plugin == "mask" && traits.oneSided) { // what is open is open from behind, too
        at.word("two-sided").adopt(std::move(inside));
        at.child("back").word("diffuse").child("reflectance").number(0);
        traits.oneSided = false;
    } else {
        at.absorb(std::move(inside));
    }
    const auto taken = [&](std::string_view property) {
        const bool found = std::ranges::any_of(at.children(), [&](const SceneNode& n) { return n.kind() == property; });
        if (found) ctx.import.leftOut(&at, bsdf.span, fmt::format("a second `{}`", bsdf.plugin), "a material has one");
        return found;
    };
    if (bsdf.plugin == "mask") {
        if (!taken("opacity")) writeNumber(at, "opacity", bsdf, "opacity", 0.5, nullptr, traits, ctx);
        return;
    }
    const bool bump = bsdf.plugin == "bumpmap";
    const auto textures = bsdf.objects("texture");
    if (textures.empty()) {
        ctx.import.diagnostics.error("E0802", bsdf.span, fmt::format("`{}` has no texture", bsdf.plugin));
        return;
    }
    if (taken(bump ? "bump" : "normal")) return;
    traits.normalMap = traits.normalMap || !bump;
    SceneNode& property = at.child(bump ? "bump" : "normal");
    if (bump) property.number(mitsubaNumber(bsdf, "scale", 1, ctx.import)).word("m");
    writeTexture(bump ? property.child("map") : property, *textures[0], true, traits, ctx);
}

// Light without polarisation goes straight on through such a filter, half of it or all.
void writePolarizing(SceneNode& at, const XmlObject& bsdf, MitsubaContext& ctx) {
    double passes = bsdf.plugin == "retarder" ? 1 : 0.5;
    if (const XmlParam* const t = bsdf.find("transmittance"))
        if (const auto spectrum = readSpectrum(*t, SpectrumUse::reflectance, ctx)) passes *= luminanceOf(*spectrum);
    at.word("diffuse").child("reflectance").number(0);
    at.child("opacity").number(1 - std::clamp(passes, 0.0, 1.0));
    mitsubaIgnore(bsdf, {"theta", "delta", "polarizing", "left_handed"});
    ctx.import.approximated(&at, bsdf.span, fmt::format("`{}`", bsdf.plugin),
                            "polarisation is not followed: what passes is what passes of light that has none");
}

void writeMeasured(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    traits.oneSided = true;
    const XmlParam* const file = bsdf.find("filename");
    const auto path = file ? findXmlFile(ctx.scene, *file, ctx.import) : std::nullopt;
    if (!file) ctx.import.diagnostics.error("E0802", bsdf.span, "`measured` needs a `filename`");
    if (!path) {
        at.word("diffuse");
        return;
    }
    traits.framed = true; // perhaps: files may be of brushed surfaces
    at.word("measured").text(ctx.import.files.refer(*path));
}

void writeUnknown(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    at.word("diffuse");
    ctx.import.leftOut(&at, bsdf.span, fmt::format("BSDF `{}`", bsdf.plugin),
                       bsdf.plugin == "measured_polarized"
                           ? "polarisation is not followed; grey and matte stands for it"
                           : "nothing here is like it; grey and matte stands for it");
    for (const XmlParam& param : bsdf.params) param.used = true;
    traits.oneSided = true;
}

void writeKnown(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    const std::string_view type = bsdf.plugin;
    if (type == "diffuse") return writeDiffuse(at, bsdf, traits, ctx);
    if (type == "conductor" || type == "roughconductor")
        return writeConductor(at, bsdf, type != "conductor", traits, ctx);
    if (type == "dielectric" || type == "roughdielectric")
        return writeDielectric(at, bsdf, type != "dielectric", traits, ctx);
    if (type == "thindielectric") return writeThinDielectric(at, bsdf, ctx);
    if (type == "plastic" || type == "roughplastic" || type == "pplastic")
        return writePlastic(at, bsdf, type != "plastic", traits, ctx);
    if (type == "polarizer" || type == "retarder" || type == "circular") return writePolarizing(at, bsdf, ctx);
    if (type == "principled" || type == "principledthin")
        return writePrincipled(at, bsdf, type != "principled", traits, ctx);
    if (type == "hair") return writeHair(at, bsdf, ctx);
    if (type == "measured") return writeMeasured(at, bsdf, traits, ctx);
    if (type == "twosided") return writeTwoSided(at, bsdf, traits, ctx);
    if (type == "blendbsdf") return writeBlend(at, bsdf, traits, ctx);
    if (type == "mask" || type == "bumpmap" || type == "normalmap") return writeWrapper(at, bsdf, traits, ctx);
    if (type == "null") {
        at.word("boundary");
        traits.boundary = true;
        return;
    }
    writeUnknown(at, bsdf, traits, ctx);
}

} // namespace

bool writeRoughness(SceneNode& at, const XmlObject& bsdf, std::string_view prefix, MaterialTraits& traits,
                    MitsubaContext& ctx) {
    const std::string roughness = std::string(prefix) + "roughness";
    if (!bsdf.has("alpha_u") && !bsdf.has("alpha_v")) {
        writeNumber(at, roughness, bsdf, "alpha", 0.1, rootOf, traits, ctx);
        return false;
    }
    const double u = std::clamp(mitsubaNumber(bsdf, "alpha_u", 0.1, ctx.import), 1e-4, 1.0);
    const double v = std::clamp(mitsubaNumber(bsdf, "alpha_v", 0.1, ctx.import), 1e-4, 1.0);
    // αv = (1 − anisotropy) αu, and the mean square is that of the round one (docs/language/materials.md).
    at.child(roughness).number(rootOf(std::sqrt((u * u + v * v) / 2)));
    const bool dielectric = at.values().ends_with("dielectric");
    traits.framed = traits.framed || u != v;
    if (u != v && !dielectric)
        at.child(std::string(prefix.empty() ? "" : prefix) + (prefix.empty() ? "anisotropy" : "roughness-anisotropy"))
            .number(1 - std::min(u, v) / std::max(u, v));
    return dielectric ? u != v : v > u;
}

void writeMaterial(SceneNode& at, const XmlObject& bsdf, MaterialTraits& traits, MitsubaContext& ctx) {
    if (ctx.depth >= kMostNestedBsdfs) {
        ctx.import.diagnostics.error("E0802", bsdf.span,
                                     fmt::format("more than {} BSDFs inside of each other", kMostNestedBsdfs));
        at.word("diffuse");
        return;
    }
    ++ctx.depth;
    writeKnown(at, bsdf, traits, ctx);
    --ctx.depth;
    mitsubaIgnore(bsdf, {"id"});
    warnOfUnused(bsdf, ctx.import);
}

const std::pair<std::string, MaterialTraits>& materialOf(const XmlObject& bsdf, MitsubaContext& ctx) {
    if (const auto* const found = ctx.materialOf[bsdf.number]) return *found;
    const auto keep = [&](std::string name,
                          const MaterialTraits& traits) -> const std::pair<std::string, MaterialTraits>& {
        return *(ctx.materialOf[bsdf.number] = &ctx.materials.emplace_back(std::move(name), traits));
    };
    if (bsdf.plugin == "null") { // needs no definition
        MaterialTraits none;
        none.boundary = true;
        warnOfUnused(bsdf, ctx.import);
        return keep("boundary", none);
    }
    const std::string name =
        ctx.materialNames.take(bsdf.id, bsdf.id.empty() ? std::string(bsdf.plugin) + "-material" : std::string());
    SceneNode made("material");
    made.name(name);
    MaterialTraits traits;
    writeMaterial(made, bsdf, traits, ctx);
    ctx.add(std::move(made));
    return keep(name, traits);
}

} // namespace abbe::exchange
