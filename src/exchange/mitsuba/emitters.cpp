#include "exchange/mitsuba/settings.h"
#include "exchange/shared/ies_writer.h"
#include "io/file.h"
#include "io/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Luminance, or what else weighs by the observer, of a flat spectrum of 1 (docs/conventions.md).
constexpr double kNitsOfOne = 72983;

std::optional<MitsubaSpectrum> lightSpectrum(const XmlObject& emitter, std::string_view param, MitsubaContext& ctx) {
    const XmlParam* const found = emitter.find(param);
    if (!found) { // 1 of D65
        MitsubaSpectrum one;
        one.kind = MitsubaSpectrum::Kind::rgb;
        one.rgb = {1, 1, 1};
        return one;
    }
    if (isTexture(*found)) {
        ctx.import.leftOut(nullptr, found->span, fmt::format("a texture of `{}`", emitter.plugin),
                           "such lights have one spectrum");
        return std::nullopt;
    }
    auto spectrum = readSpectrum(*found, SpectrumUse::light, ctx);
    if (spectrum) *spectrum = scaled(*spectrum, mitsubaNumber(emitter, "scale", 1, ctx.import));
    return spectrum;
}

// An amount in the unit, and the colour.
void writeAmount(SceneNode& light, const char* property, const char* unit, const MitsubaSpectrum& spectrum, Span span,
                 MitsubaContext& ctx, double factor = 1) {
    const double y = luminanceOf(spectrum);
    light.child(property).number(std::max(0.0, kNitsOfOne * y * factor)).word(unit);
    if (!(y > 0)) return;
    SceneNode& color = light.child("color");
    MitsubaSpectrum shape = spectrum;
    if (shape.kind == MitsubaSpectrum::Kind::flat) shape.value = 1;
    writeSpectrum(color, shape, SpectrumUse::light, span, ctx);
}

Vec3d positionOf(const XmlObject& emitter, const Transform& map, MitsubaContext& ctx) {
    if (const auto position = mitsubaVector(emitter, "position", ctx.import)) return *position;
    return map.t;
}

void convertPoint(const XmlObject& emitter, MitsubaContext& ctx) {
    const auto spectrum = lightSpectrum(emitter, "intensity", ctx);
    const Transform map = mitsubaTransform(emitter);
    const Vec3d at = positionOf(emitter, map, ctx);
    if (!spectrum) return;
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "point-light")).word("point");
    light.child("position").vector(at);
    writeAmount(light, "intensity", "cd", *spectrum, emitter.span, ctx);
}

void convertSpot(const XmlObject& emitter, MitsubaContext& ctx) {
    const auto spectrum = lightSpectrum(emitter, "intensity", ctx);
    const Transform map = mitsubaTransform(emitter);
    const double cutoff = std::clamp(mitsubaNumber(emitter, "cutoff_angle", 20, ctx.import), 0.01, 180.0);
    const double beam = std::clamp(mitsubaNumber(emitter, "beam_width", 0.75 * cutoff, ctx.import), 0.0, cutoff);
    if (emitter.has("texture")) {
        emitter.find("texture");
        ctx.import.leftOut(nullptr, emitter.span, "the texture of `spot`", "spots have no pictures");
    }
    if (!spectrum) return;
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "spot-light")).word("spot");
    light.child("position").vector(map.t);
    light.child("toward").vector(map.vector({0, 0, 1}));
    light.child("angle").number(2 * cutoff).word("deg");
    light.child("inner-angle").number(2 * beam).word("deg");
    writeAmount(light, "intensity", "cd", *spectrum, emitter.span, ctx);
    if (beam < cutoff)
        ctx.import.approximated(&light, emitter.span, "the edge of `spot`",
                                "it falls by a smooth step of the cosine instead of evenly with the angle");
}

void convertDirectional(const XmlObject& emitter, MitsubaContext& ctx) {
    const auto spectrum = lightSpectrum(emitter, "irradiance", ctx);
    const Transform map = mitsubaTransform(emitter);
    const Vec3d toward = mitsubaVector(emitter, "direction", ctx.import).value_or(map.vector({0, 0, 1}));
    if (!spectrum) return;
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "directional")).word("sun");
    light.child("toward").vector(toward);
    light.child("angular-diameter").number(0).word("deg");
    writeAmount(light, "irradiance", "lx", *spectrum, emitter.span, ctx);
}

void convertConstant(const XmlObject& emitter, MitsubaContext& ctx) {
    const auto spectrum = lightSpectrum(emitter, "radiance", ctx);
    if (!spectrum) return;
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "surroundings")).word("sky");
    writeSpectrum(light.child("radiance"), *spectrum, SpectrumUse::light, emitter.span, ctx);
    hideFromCamera(light, false, ctx);
}

// The middle of Mitsuba's image lies towards +z, ours towards −z.
void convertEnvmap(const XmlObject& emitter, MitsubaContext& ctx) {
    const XmlParam* const file = emitter.find("filename");
    const double scale = mitsubaNumber(emitter, "scale", 1, ctx.import);
    const Transform map = mitsubaTransform(emitter);
    mitsubaIgnore(emitter, {"mis_compensation"});
    if (!file) {
        ctx.import.diagnostics.error("E0802", emitter.span, "`envmap` needs a `filename`");
        return;
    }
    const auto path = findXmlFile(ctx.scene, *file, ctx.import);
    if (!path || !(scale > 0)) return;
    std::string ending = path->extension().string();
    std::ranges::transform(ending, ending.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (ending != ".exr" && ending != ".hdr" && ending != ".rgbe") {
        ctx.import.leftOut(nullptr, file->span, fmt::format("envmap `{}`", file->text),
                           "surroundings are EXR or Radiance HDR images: convert it");
        return;
    }
    SceneNode& light = ctx.define("light")
                           .name(ctx.shapeNames.take(emitter.id, "surroundings"))
                           .word("environment")
                           .text(ctx.import.files.refer(*path));
    if (scale != 1) light.child("exposure").number(std::clamp(std::log2(scale), -100.0, 100.0)).word("stops");
    writeTransform(light, Transform::scale({-1, 1, -1}).then(map));
    hideFromCamera(light, false, ctx);
}

void leaveOutEmitter(const XmlObject& emitter, std::string_view why, MitsubaContext& ctx) {
    ctx.import.leftOut(nullptr, emitter.span, fmt::format("emitter `{}`", emitter.plugin), why);
    for (const XmlParam& param : emitter.params) param.used = true;
}

// Light that leaves a disk at right angles is a beam. Its radiance is a delta in direction: power per area.
void convertDirectionalArea(const XmlObject& emitter, const XmlObject& shape, MitsubaContext& ctx) {
    if (shape.plugin != "disk") return leaveOutEmitter(emitter, "only disks send beams", ctx);
    const auto spectrum = lightSpectrum(emitter, "radiance", ctx);
    const Transform map = mitsubaTransform(shape);
    const auto size = map.uniformScale();
    if (!spectrum) return;
    if (!size) return leaveOutEmitter(emitter, "only round disks send beams", ctx);
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "beam")).word("beam");
    light.child("position").vector(map.t);
    light.child("toward").vector(map.vector({0, 0, 1}));
    light.child("radius").number(*size);
    writeAmount(light, "irradiance", "lx", *spectrum, emitter.span, ctx);
}

// The picture lies in the plane at distance 1 of what Mitsuba's cameras see, where a 1 of it is an irradiance of π.
void convertProjector(const XmlObject& emitter, MitsubaContext& ctx) {
    const double scale = mitsubaNumber(emitter, "scale", 1, ctx.import);
    const Transform map = mitsubaTransform(emitter);
    const auto inverse = map.inverse();
    const XmlParam* const picture = emitter.find("irradiance");
    const bool isPicture = picture && isTexture(*picture);
    RgbImage image;
    std::string stem = "projector";
    if (isPicture) {
        const XmlParam* const file = picture->object->find("filename");
        const auto path = file ? findXmlFile(ctx.scene, *file, ctx.import) : std::nullopt;
        if (!file) return leaveOutEmitter(emitter, "its picture is in no file", ctx);
        if (!path) return;
        stem = path->stem().string();
        try {
            image = readImage(path->string());
        } catch (const IoError& fault) {
            return leaveOutEmitter(emitter, fault.what(), ctx);
        }
        for (const XmlParam& param : picture->object->params) param.used = true;
    } else {
        image.window = {0, 0, 1, 1};
        image.rgb = {1, 1, 1};
    }
    const int width = image.width(), height = image.height();
    const double aspect = static_cast<double>(width) / height;
    const double tangent = std::tan(horizontalFov(emitter, aspect, ctx) * kDegree / 2);
    if (!inverse || !(scale > 0)) return leaveOutEmitter(emitter, "it is dark, or its transform has no inverse", ctx);
    const auto at = [&](Vec3d d, std::size_t channel) {
        const Vec3d w = normalize(inverse->vector(d));
        if (w.z <= 1e-3) return 0.0;
        const double u = (1 - w.x / (w.z * tangent)) / 2, v = (1 - w.y * aspect / (w.z * tangent)) / 2;
        if (u < 0 || u >= 1 || v < 0 || v >= 1) return 0.0;
        const auto pixel = static_cast<std::size_t>(static_cast<int>(v * height) * width + static_cast<int>(u * width));
        return static_cast<double>(image.rgb[3 * pixel + channel]) * scale * kPiD * kNitsOfOne / std::pow(w.z, 3);
    };
    const auto write = [&](const std::string& text, const std::string& name) -> SceneNode* {
        if (text.empty()) return nullptr;
        SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "projector")).word("ies");
        light.text(ctx.import.files.write(name, "ies", text)).child("position").vector(map.t);
        return &light;
    };
    if (isPicture) {
        constexpr std::array<double, 3> kLuminance = {0.2126, 0.7152, 0.0722}; // Rec. 709
        for (std::size_t c = 0; c < 3; ++c)
            if (SceneNode* const light = write(iesFile([&](Vec3d d) { return kLuminance[c] * at(d, c); }),
                                               fmt::format("{}-{}", stem, "rgb"[c])))
                light->child("color").word("rgb").vector({c == 0 ? 1.0 : 0.0, c == 1 ? 1.0 : 0.0, c == 2 ? 1.0 : 0.0});
    } else if (auto spectrum = lightSpectrum(emitter, "irradiance", ctx)) {
        const double y = luminanceOf(*spectrum) / scale; // lightSpectrum() has taken the factor in
        if (SceneNode* const light = write(iesFile([&](Vec3d d) { return y * at(d, 0); }), stem)) {
            if (spectrum->kind == MitsubaSpectrum::Kind::flat) spectrum->value = 1;
            writeSpectrum(light->child("color"), *spectrum, SpectrumUse::light, emitter.span, ctx);
        }
    }
    ctx.import.approximated(nullptr, emitter.span, "`projector`",
                            "its picture became photometric files in steps of half a degree");
}

} // namespace

void hideFromCamera(SceneNode& light, bool placed, const MitsubaContext& ctx) {
    if (!ctx.hideEmitters) return;
    SceneNode& rays = light.child("visible-to").word("reflections");
    if (placed) rays.word("shadows");
}

void noteEmitterTextures(const XmlObject& emitter, MaterialTraits& traits) {
    for (const XmlParam& param : emitter.params)
        if (isTexture(param)) {
            if (param.object->has("to_uv") && !traits.textured) traits.toUv = mitsubaTransform(*param.object, "to_uv");
            traits.textured = true;
        }
}

void writeShapeEmitter(SceneNode& node, const XmlObject& emitter, const XmlObject& shape, MitsubaContext& ctx) {
    if (emitter.plugin == "directionalarea") {
        convertDirectionalArea(emitter, shape, ctx);
    } else if (emitter.plugin != "area") {
        leaveOutEmitter(emitter, "it is none that shapes have", ctx);
    } else {
        const XmlParam* const radiance = emitter.find("radiance");
        MaterialTraits traits;
        if (radiance && isTexture(*radiance))
            writeTexture(node.child("emission"), *radiance->object, false, traits, ctx);
        else if (const auto spectrum = lightSpectrum(emitter, "radiance", ctx))
            writeSpectrum(node.child("emission"), *spectrum, SpectrumUse::light, emitter.span, ctx);
        mitsubaIgnore(emitter, {"scale"});
        hideFromCamera(node, true, ctx);
    }
    mitsubaIgnore(emitter, {"id", "sampling_weight", "to_world"});
    warnOfUnused(emitter, ctx.import);
}

void convertEmitter(const XmlObject& emitter, MitsubaContext& ctx) {
    const std::string_view type = emitter.plugin;
    mitsubaIgnore(emitter, {"sampling_weight"});
    if (type == "constant")
        convertConstant(emitter, ctx);
    else if (type == "envmap")
        convertEnvmap(emitter, ctx);
    else if (type == "point")
        convertPoint(emitter, ctx);
    else if (type == "spot")
        convertSpot(emitter, ctx);
    else if (type == "directional")
        convertDirectional(emitter, ctx);
    else if (type == "sunsky" || type == "sky" || type == "sun" || type == "timed_sunsky")
        convertSky(emitter, ctx);
    else if (type == "projector")
        convertProjector(emitter, ctx);
    else
        leaveOutEmitter(emitter,
                        type == "area" || type == "directionalarea" ? "it belongs into a shape" : "no light is like it",
                        ctx);
    for (const char* name : {"to_world"}) mitsubaIgnore(emitter, {name});
    warnOfUnused(emitter, ctx.import);
}

} // namespace abbe::exchange
