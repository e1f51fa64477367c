#include "exchange/mitsuba/textures.h"

#include "exchange/mitsuba/media.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kMostNestedTextures = 100; // materials around them count, too

bool sameMap(const Transform& a, const Transform& b) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (a.a[r][c] != b.a[r][c]) return false;
    return a.t == b.t;
}

// A material's textures share the coordinates of its shapes, so they share `to_uv`.
void noteMap(const XmlObject& texture, MaterialTraits& traits, MitsubaContext& ctx) {
    const bool first = !traits.textured;
    traits.textured = true;
    const XmlParam* const param = texture.find("to_uv");
    const Transform map = mitsubaTransform(texture, "to_uv");
    if (first && !isIdentity(map)) traits.toUv = map;
    if (!first && !sameMap(map, traits.toUv.value_or(Transform{})))
        ctx.import.approximated(nullptr, param ? param->span : texture.span, "`to_uv`",
                                "the textures of a material share one; that of the first is used");
}

void writeBitmap(SceneNode& at, const XmlObject& texture, MitsubaContext& ctx) {
    const XmlParam* const file = texture.find("filename");
    if (!file) {
        ctx.import.diagnostics.error("E0802", texture.span, "a bitmap needs a `filename`");
        at.word("checker");
        return;
    }
    const auto path = findXmlFile(ctx.scene, *file, ctx.import);
    at.word("image").text(path ? ctx.import.files.refer(*path) : file->text);
    if (mitsubaFlag(texture, "raw", false, ctx.import)) at.key("space", "data");
    const std::string wrap = mitsubaText(texture, "wrap_mode", "repeat");
    if (wrap == "mirror" || wrap == "clamp") at.child("wrap").word(wrap);
    if (mitsubaText(texture, "filter_type", "bilinear") == "nearest")
        ctx.import.approximated(nullptr, texture.span, "`filter_type` nearest",
                                "images are smooth between their pixels");
    mitsubaIgnore(texture, {"accel", "format", "gamma", "max_anisotropy", "cache"});
}

void writeChecker(SceneNode& at, const XmlObject& texture, bool data, MaterialTraits& traits, MitsubaContext& ctx) {
    // Squares of half a unit; turning v over exchanges the two colours. Mitsuba 3.9.1 itself exchanges them where a
    // number is asked for.
    at.word("checker");
    writeColor(at, data ? "odd" : "even", texture, "color1", SpectrumUse::reflectance, 0.2, traits, ctx);
    writeColor(at, data ? "even" : "odd", texture, "color0", SpectrumUse::reflectance, 0.4, traits, ctx);
    at.child("scale").number(2);
}

void writeAttribute(SceneNode& at, const XmlObject& texture, MitsubaContext& ctx) {
    std::string name = mitsubaText(texture, "name");
    if (name.starts_with("vertex_"))
        name = name.substr(7);
    else
        ctx.import.leftOut(nullptr, texture.span, fmt::format("attribute `{}`", name),
                           "only values of vertices are read, not those of faces");
    at.word("attribute").text(name.empty() ? "color" : name);
    if (const double scale = mitsubaNumber(texture, "scale", 1, ctx.import); scale != 1)
        ctx.import.leftOut(nullptr, texture.span, "`scale` of a mesh attribute", "values are used as they are");
}

// A picture in space: nothing here holds one, so that its mean stands for it.
void writeVolumeTexture(SceneNode& at, const XmlObject& texture, MitsubaContext& ctx) {
    const auto volumes = texture.objects("volume");
    const XmlObject* const volume = volumes.empty() ? nullptr : volumes[0];
    std::string grey = "0.5";
    if (volume && volume->plugin == "constvolume") {
        const XmlParam* const value = volume->find("value");
        SceneNode color("color");
        if (value)
            if (const auto spectrum = readSpectrum(*value, SpectrumUse::reflectance, ctx))
                writeSpectrum(color, *spectrum, SpectrumUse::reflectance, value->span, ctx);
        if (!color.empty()) grey = color.values();
    } else if (volume && volume->plugin == "gridvolume") {
        grey = numberText(std::clamp(meanOfGrid(*volume, ctx), 0.0, 1.0));
    } else {
        ctx.import.leftOut(nullptr, texture.span, "texture `volume`", "its volume is no grid; grey stands for it");
    }
    at.word("ramp");
    at.child("stop").number(0).word(grey);
    at.child("stop").number(1).word(grey);
}

void writeTextureType(SceneNode& at, const XmlObject& texture, bool data, MaterialTraits& traits, MitsubaContext& ctx) {
    if (ctx.depth >= kMostNestedTextures) {
        ctx.import.diagnostics.error("E0802", texture.span,
                                     fmt::format("more than {} textures inside of each other", kMostNestedTextures));
        at.word("checker");
        return;
    }
    ++ctx.depth;
    noteMap(texture, traits, ctx);
    if (texture.plugin == "bitmap")
        writeBitmap(at, texture, ctx);
    else if (texture.plugin == "checkerboard")
        writeChecker(at, texture, data, traits, ctx);
    else if (texture.plugin == "mesh_attribute")
        writeAttribute(at, texture, ctx);
    else if (texture.plugin == "volume")
        writeVolumeTexture(at, texture, ctx);
    else {
        ctx.import.leftOut(nullptr, texture.span, fmt::format("texture `{}`", texture.plugin),
                           "nothing here is like it; grey stands for it");
        at.word("ramp");
        at.child("stop").number(0).number(0.5);
        at.child("stop").number(1).number(0.5);
        for (const XmlParam& param : texture.params) param.used = true;
    }
    --ctx.depth;
    warnOfUnused(texture, ctx.import);
}

} // namespace

void writeTexture(SceneNode& at, const XmlObject& texture, bool data, MaterialTraits& traits, MitsubaContext& ctx) {
    if (texture.id.empty()) return writeTextureType(at, texture, data, traits, ctx);
    std::string& name = ctx.textures[&texture];
    if (name.empty()) {
        name = ctx.textureNames.take(texture.id, "texture");
        SceneNode made("texture");
        made.name(name);
        writeTextureType(made, texture, data, traits, ctx);
        ctx.import.nodes.push_back(std::move(made));
    } else {
        noteMap(texture, traits, ctx);
    }
    at.name(ctx.textures[&texture]);
}

void writeColor(SceneNode& parent, std::string property, const XmlObject& object, std::string_view name,
                SpectrumUse use, std::optional<double> otherwise, MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlParam* const param = object.find(name);
    if (!param) {
        if (otherwise) parent.child(std::move(property)).number(*otherwise);
        return;
    }
    if (isTexture(*param)) return writeTexture(parent.child(std::move(property)), *param->object, false, traits, ctx);
    if (const auto spectrum = readSpectrum(*param, use, ctx))
        writeSpectrum(parent.child(std::move(property)), *spectrum, use, param->span, ctx);
}

void writeNumber(SceneNode& parent, std::string property, const XmlObject& object, std::string_view name,
                 std::optional<double> otherwise, const NumberMap& map, MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlParam* const param = object.find(name);
    if (!param || !isTexture(*param)) {
        std::optional<double> value = otherwise;
        if (param && param->object) {
            if (const auto s = readSpectrum(*param, SpectrumUse::positive, ctx)) value = luminanceOf(*s);
        } else if (param && param->tag != kBrokenTag)
            value = param->numbers.size() == 3 ? param->numbers[1]
                                               : mitsubaNumber(object, name, otherwise.value_or(0), ctx.import);
        if (value) parent.child(std::move(property)).number(map ? map(*value) : *value);
        return;
    }
    SceneNode& node = parent.child(std::move(property));
    if (!map) return writeTexture(node, *param->object, true, traits, ctx);
    // Stops at squares, for maps that are roots.
    node.word("ramp");
    writeTexture(node.child("input"), *param->object, true, traits, ctx);
    constexpr int kStops = 12;
    for (int i = 0; i <= kStops; ++i) {
        const double x = static_cast<double>(i * i) / (kStops * kStops);
        node.child("stop").number(x).number(map(x));
    }
}

} // namespace abbe::exchange
