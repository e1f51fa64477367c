#include "exchange/mitsuba/settings.h"

#include <algorithm>
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

void hideFromCamera(SceneNode& light, bool placed, const MitsubaContext& ctx) {
    if (!ctx.hideEmitters) return;
    SceneNode& rays = light.child("visible-to").word("reflections");
    if (placed) rays.word("shadows");
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

// z is up in the sky's own space.
void convertSky(const XmlObject& emitter, MitsubaContext& ctx) {
    const Transform map = mitsubaTransform(emitter);
    SceneNode& light = ctx.define("light").name(ctx.shapeNames.take(emitter.id, "sky")).word("daylight");
    ctx.import.approximated(&light, emitter.span, fmt::format("`{}`", emitter.plugin),
                            "by Abbe's own daylight, in absolute units: brightness and colours differ");
    const auto sun = mitsubaVector(emitter, "sun_direction", ctx.import);
    if (sun)
        light.child("toward").vector({-sun->x, -sun->z, sun->y});
    else
        ctx.import.leftOut(&light, emitter.span, "the date and place of the sun",
                           "without `sun_direction` the sun stands where daylight has it by default");
    light.child("turbidity").number(std::clamp(mitsubaNumber(emitter, "turbidity", 3, ctx.import), 1.0, 10.0));
    MaterialTraits none;
    writeColor(light, "ground-albedo", emitter, "albedo", SpectrumUse::reflectance, 0.3, none, ctx);
    if (emitter.plugin == "sky" || mitsubaNumber(emitter, "sun_scale", 1, ctx.import) == 0)
        light.child("sun").word("off");
    for (const char* param : {"sky_scale", "sun_scale", "scale"})
        if (const double factor = mitsubaNumber(emitter, param, 1, ctx.import); factor != 1 && factor != 0)
            ctx.import.leftOut(&light, emitter.span, fmt::format("`{}`", param),
                               "daylight is as bright as it is; the camera has an `exposure`");
    mitsubaIgnore(emitter, {"sun_aperture", "year", "month", "day", "hour", "minute", "second", "latitude", "longitude",
                            "timezone", "complex_sun", "to_world", "stretch", "resolution"});
    writeTransform(light, Transform::rotate({1, 0, 0}, kPiD / 2).then(map));
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

} // namespace

void noteEmitterTextures(const XmlObject& emitter, MaterialTraits& traits) {
    for (const XmlParam& param : emitter.params)
        if (isTexture(param)) {
            if (const auto map = std::ranges::find(param.object->params, "to_uv", &XmlParam::name);
                map != param.object->params.end() && !traits.textured)
                traits.toUv = map->transform;
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
    const std::string& type = emitter.plugin;
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
        leaveOutEmitter(emitter, "no light throws a picture", ctx);
    else
        leaveOutEmitter(emitter,
                        type == "area" || type == "directionalarea" ? "it belongs into a shape" : "no light is like it",
                        ctx);
    for (const char* name : {"to_world"}) mitsubaIgnore(emitter, {name});
    warnOfUnused(emitter, ctx.import);
}

} // namespace abbe::exchange
