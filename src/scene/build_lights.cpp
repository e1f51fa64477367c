#include "io/ies.h"
#include "io/image.h"
#include "lights/area_light.h"
#include "lights/beam_light.h"
#include "lights/daylight_light.h"
#include "lights/environment_light.h"
#include "lights/ies_light.h"
#include "lights/moving_light.h"
#include "lights/point_light.h"
#include "lights/sky_light.h"
#include "lights/spot_light.h"
#include "lights/sun_light.h"
#include "scene/file_faults.h"
#include "scene/rgb_radiance.h"
#include "scene/scene_builder.h"

#include <fmt/format.h>

namespace abbe {

LightContext SceneBuilder::lightContext(const Definition& d, const Motion& toRender) {
    LightContext context;
    context.toRender = atOpening(toRender);
    context.defaultColor = curves_.daylight();
    context.span = d.span;
    context.zUp = tree_.header.zUp;
    context.time = built_->shutter.open;
    return context;
}

// Lights with a place are chosen by their power, in single precision.
bool SceneBuilder::checkPower(const Light& light, Span span) {
    constexpr LightRange kRange = {1e-30, 1e35, "W"};
    const double power = light.power();
    if (!light.bounds(0) || kRange.holds(power)) return true;
    reportBeyondRange(power, kRange, "light", span, fmt::format("gives off {:.3g} W", power), diagnostics_)
        .notes.push_back(
            fmt::format("the power of a light is 0, or between {:g} and {:g} W", kRange.least, kRange.most));
    return false;
}

void SceneBuilder::addLight(std::unique_ptr<Light> light, const Definition& d, Visibility visible) {
    if (!light) return;
    light->setVisible(visible);
    if (!(light->power() > 0)) diagnostics_.warning("W0740", d.span, "this light is dark; no light is asked of it");
    if (!checkPower(*light, d.span)) return;
    built_->scene.names[light.get()] = nameOf(d);
    if (const MediumEmission* glow = light->emission()) built_->scene.names[glow] = nameOf(d);
    lights_.push_back(std::move(light));
    lightNames_.emplace_back(d.name, d.type ? std::string(d.type->name) : std::string());
}

// What a texture of radiance makes of white: as `radiance rgb 1 1 1` in its colour space, or 1 if it has none.
const Curve* SceneBuilder::textureWhite(const Texture& texture) {
    const RgbSpace* const space = texture.rgbSpace();
    const Curve*& white = textureWhites_[space];
    if (!white) white = space ? curves_.white(*space) : curves_.constant(1);
    return white;
}

// The shape's own emission, or else that of its material; no curve for none.
SceneBuilder::Emission SceneBuilder::emissionOf(const LoadedShape& shape) {
    const schema::TexturedSpectrum& emission = shape.common.emission;
    if (emission.texture) return {{textureWhite(*emission.texture), 1}, emission.texture, emission.span};
    if (emission.curve) return {{emission.curve, 1}, nullptr, {}};
    const Material* material = materialOf(shape.common);
    const SurfaceEmission own = material ? material->emission() : SurfaceEmission{};
    if (!(own.luminance > 0)) return {};
    const Curve* color = own.color ? own.color : curves_.daylight();
    const auto ofWhite = scaleFor({own.luminance, schema::Dimension::luminance, {}}, *curves_.daylight(), 1);
    return {{color, ofWhite.value_or(0)}, own.texture, shape.definition->span, own.bothSides, own.veil};
}

const Light* SceneBuilder::emitterOf(const LoadedShape& shape, const Shape& placed, const Motion& toRender,
                                     Visibility visible) {
    const Emission emission = emissionOf(shape);
    const Definition& d = *shape.definition;
    std::optional<LightMotion> motion;
    if (!emission.radiance.curve || !lightMotion(toRender, d.span, motion)) return nullptr;
    if (!checkLightRange(emission.radiance, kSurfaceRadiance, emission.span.valid() ? emission.span : d.span,
                         diagnostics_))
        return nullptr;
    // A light that is sampled would shine from its holes, too.
    if (const Material* material = materialOf(shape.common); material && material->mayBeOpen()) {
        diagnostics_.error("E0754", d.span, "a shape that shines has a material with holes", "its `opacity` is below 1")
            .help = "take the opacity off, or put the light behind a shape with holes";
        return nullptr;
    }
    std::unique_ptr<const LightTexture> texture;
    if (emission.texture) {
        if (!checkLightTexture(*emission.texture, emission.span, d, placed)) return nullptr;
        const Transform toOwn = atOpening(toRender).inverse().value_or(Transform{});
        texture = std::make_unique<const LightTexture>(placed, *emission.texture, toOwn, *emission.radiance.curve,
                                                       options_.geometry);
        if (texture->black()) diagnostics_.warning("W0740", d.span, "this light is dark; no light is asked of it");
    }
    const bool both = emission.bothSides;
    if (motion)
        lights_.push_back(std::make_unique<MovingAreaLight>(placed, emission.radiance, both, std::move(*motion),
                                                            std::move(texture), emission.veil));
    else
        lights_.push_back(
            std::make_unique<AreaLight>(placed, emission.radiance, both, std::move(texture), emission.veil));
    if (!checkPower(*lights_.back(), d.span)) return lights_.pop_back(), nullptr;
    lights_.back()->setVisible(visible);
    lightNames_.emplace_back(d.name, "shape");
    built_->scene.names[lights_.back().get()] = nameOf(d);
    return lights_.back().get();
}

template <typename P, typename Make>
void SceneBuilder::placeBareLight(const Definition& d, const Place& place, Make make) {
    const auto params = bound<P>(d);
    if (!params) return;
    LightContext context = lightContext(d, place.motion);
    std::optional<LightMotion> motion;
    if (!lightMotion(within(place.motion, params->transform), d.span, motion)) return;
    if (motion) context.motion = &*motion;
    Visibility visible = place.visible;
    if constexpr (std::derived_from<P, VisibleParams>) visible = visible & visibilityOf(params->visibleTo);
    addLight(inMotion(make(*params, context, diagnostics_), context), d, visible);
}

void SceneBuilder::placeDaylight(const Definition& d, const Place& place) {
    const auto params = bound<DaylightParams>(d);
    if (!params) return;
    LightContext context = lightContext(d, place.motion);
    std::optional<LightMotion> motion;
    if (!lightMotion(within(place.motion, params->transform), d.span, motion)) return;
    if (motion) context.motion = &*motion;
    for (auto& light : makeDaylight(*params, context, diagnostics_))
        addLight(inMotion(std::move(light), context), d, place.visible & visibilityOf(params->visibleTo));
}

void SceneBuilder::placeLight(const Definition& d, const Place& place) {
    if (place.object) {
        place.object->unshared.push_back({&d, place.motion, place.visible});
        return;
    }
    const std::string_view type = d.type ? d.type->name : "";
    if (type == "point") {
        placeBareLight<PointLightParams>(d, place, makePointLight);
    } else if (type == "spot") {
        placeBareLight<SpotLightParams>(d, place, makeSpotLight);
    } else if (type == "beam") {
        placeBareLight<BeamLightParams>(d, place, makeBeamLight);
    } else if (type == "sun") {
        placeBareLight<SunLightParams>(d, place, makeSunLight);
    } else if (type == "sky") {
        if (const auto p = bound<SkyLightParams>(d))
            addLight(makeSkyLight(*p, lightContext(d, place.motion), diagnostics_), d,
                     place.visible & visibilityOf(p->visibleTo));
    } else if (type == "ies") {
        placeBareLight<IesLightParams>(
            d, place,
            [this](const IesLightParams& p, const LightContext& context, Diagnostics&) { return makeIes(p, context); });
    } else if (type == "daylight") {
        placeDaylight(d, place);
    } else if (type == "environment") {
        placeBareLight<EnvironmentLightParams>(d, place,
                                               [this](const EnvironmentLightParams& p, const LightContext& context,
                                                      Diagnostics&) { return makeEnvironment(p, context); });
    } else {
        placeAreaLight(d, place);
    }
}

std::unique_ptr<Light> SceneBuilder::makeIes(const IesLightParams& params, const LightContext& context) {
    IntensityTable table;
    if (!readsFile(
            params.file.value, params.file.span, diagnostics_, [&] { table = readIes(params.file.value); }, "E0752"))
        return nullptr;
    auto light = makeIesLight(params, std::move(table), context, diagnostics_);
    built_->facts.files.push_back(params.file.value);
    return light;
}

std::unique_ptr<Light> SceneBuilder::makeEnvironment(const EnvironmentLightParams& params,
                                                     const LightContext& context) {
    const std::string& path = params.image.value;
    RgbImage file;
    if (!readsFile(path, params.image.span, diagnostics_, [&] { file = readImage(path); })) return nullptr;
    built_->facts.files.push_back(path);
    RgbSpace space = file.chromaticities ? file.chromaticities->space() : rgb::rec709;
    for (const auto& [key, word] : params.image.keys)
        if (key == "space") space = findRgbSpace(word).value_or(space);
    std::string reason;
    auto upsampling = makeRgbRadiance(space, reason);
    if (!upsampling) {
        diagnostics_.error("E0403", params.image.span, reason);
        return nullptr;
    }
    const bool compensated = built_->render.strategy.word == "mis"; // else its samples must cover everything
    auto light = makeEnvironmentLight(params, {file.width(), file.height(), std::move(file.rgb)}, std::move(upsampling),
                                      compensated, context, diagnostics_);
    if (light && !(light->power() > 0)) {
        diagnostics_.warning("W0602", params.image.span, "this environment is black; the light is left out");
        return nullptr;
    }
    return light;
}

std::unique_ptr<const Shape> SceneBuilder::lightShape(const Definition& d, const Transform& toRender,
                                                      AreaLightParams& amount) {
    const std::string_view type = d.type ? d.type->name : "";
    const auto take = [&](const auto& params) {
        amount = params;
        return params.transform.at(built_->shutter.open).then(toRender);
    };
    if (type == "quad") {
        if (const auto p = bound<LightQuadParams>(d))
            return makeQuad(p->points, p->size, take(*p), d.span, diagnostics_);
    } else if (type == "disk") {
        if (const auto p = bound<LightDiskParams>(d))
            return makeDisk(p->center, p->normal, p->radius, take(*p), d.span, diagnostics_);
    } else if (type == "sphere") {
        if (const auto p = bound<LightSphereParams>(d))
            return makeSphere(p->center, p->radius, take(*p), d.span, diagnostics_);
    } else if (type == "mesh") {
        const auto p = bound<LightMeshParams>(d);
        if (!p) return nullptr;
        const Vec3d origin = farMiddle(p->points);
        auto mesh = loadMesh(p->file, tree_.header.length, relativeTo(origin, p->points), p->faces, d.span,
                             diagnostics_, tree_.header.zUp);
        if (!mesh) return nullptr;
        if (!p->file.value.empty()) built_->facts.files.push_back(p->file.value);
        return placeMesh(std::move(*mesh), Transform::translate(origin).then(take(*p)), d.span, diagnostics_);
    } else {
        bound<AreaLightParams>(d); // unknown type: report what is wrong besides
    }
    return nullptr;
}

// The texture of an area light, if it has one; false after an error.
bool SceneBuilder::takeTexture(const AreaLightParams& params, const Shape& shape, const Definition& d,
                               LightContext& context) {
    context.texturesOpen = options_.geometry;
    context.texture = params.radiance.texture;
    Span asker = params.radiance.span;
    if (params.texture.valid()) {
        if (context.texture) {
            diagnostics_
                .error("E0755", asker, "`texture` has no effect beside a `radiance` that is a texture itself",
                       "this texture")
                .help = "multiply the two: `texture product { first …; second … }`";
            return false;
        }
        for (const schema::Node& property : d.properties)
            if (property.name() == "texture") asker = property.nameSpan();
        context.texture = textureFor(params.texture, TextureUse::light, asker);
        if (!context.texture) return false;
    }
    if (!context.texture) return true;
    context.textureWhite = textureWhite(*context.texture);
    return checkLightTexture(*context.texture, asker, d, shape);
}

void SceneBuilder::placeAreaLight(const Definition& d, const Place& outer) {
    AreaLightParams amount;
    auto shape = lightShape(d, atOpening(outer.motion), amount);
    if (!shape) return;
    carry(amount.transform, outer, d.span, [&](const Place& place) {
        LightContext context = lightContext(d, outer.motion);
        std::optional<LightMotion> motion;
        if (!lightMotion(place.motion, d.span, motion) || !takeTexture(amount, *shape, d, context)) return;
        const auto toOwn = amount.transform.at(built_->shutter.open).then(atOpening(outer.motion)).inverse();
        context.toOwn = toOwn.value_or(Transform{});
        if (motion) context.motion = &*motion;
        auto light = makeAreaLight(amount, *shape, context, diagnostics_);
        if (!light || !checkPower(*light, d.span)) return;
        // A lamp emits and reflects nothing.
        const Shape* const placed = keepShape(std::move(shape));
        built_->scene.names[placed] = nameOf(d);
        built_->declared[placed] = d.nameSpan;
        noteBounds(d, placed->bounds(), place);
        const Visibility visible = place.visible & visibilityOf(amount.visibleTo);
        noteVisible(visible, {}, d);
        addPlaced(*placed, {plainMaterial(0), light.get(), toOwn, context.texture != nullptr, visible}, place);
        addLight(std::move(light), d, visible);
    });
}

} // namespace abbe
