#include "io/image.h"
#include "io/io_error.h"
#include "lights/area_light.h"
#include "lights/environment_light.h"
#include "lights/point_light.h"
#include "lights/sky_light.h"
#include "lights/spot_light.h"
#include "lights/sun_light.h"
#include "scene/rgb_radiance.h"
#include "scene/scene_builder.h"

#include <fmt/format.h>

namespace abbe {

LightContext SceneBuilder::lightContext(const Definition& d, const Transform& toRender) {
    return {toRender, curves_.daylight(), d.span, tree_.header.zUp};
}

void SceneBuilder::addLight(std::unique_ptr<Light> light, const Definition& d) {
    if (!light) return;
    lights_.push_back(std::move(light));
    lightNames_.emplace_back(d.name, d.type ? std::string(d.type->name) : std::string());
}

const Light* SceneBuilder::emitterOf(const LoadedShape& shape, const Shape& placed) {
    if (!shape.common.emission) return nullptr;
    lights_.push_back(std::make_unique<AreaLight>(placed, ScaledCurve{shape.common.emission, 1}, false));
    lightNames_.emplace_back(shape.definition->name, "shape");
    return lights_.back().get();
}

void SceneBuilder::placeLight(const Definition& d, const Transform& toRender) {
    const LightContext context = lightContext(d, toRender);
    const std::string_view type = d.type ? d.type->name : "";
    if (type == "point") {
        if (const auto p = bound<PointLightParams>(d)) addLight(makePointLight(*p, context, diagnostics_), d);
    } else if (type == "spot") {
        if (const auto p = bound<SpotLightParams>(d)) addLight(makeSpotLight(*p, context, diagnostics_), d);
    } else if (type == "sun") {
        if (const auto p = bound<SunLightParams>(d)) addLight(makeSunLight(*p, context, diagnostics_), d);
    } else if (type == "sky") {
        if (const auto p = bound<SkyLightParams>(d)) addLight(makeSkyLight(*p, context, diagnostics_), d);
    } else if (type == "environment") {
        placeEnvironment(d, context);
    } else {
        placeAreaLight(d, toRender);
    }
}

void SceneBuilder::placeEnvironment(const Definition& d, const LightContext& context) {
    const auto params = bound<EnvironmentLightParams>(d);
    if (!params) return;
    const std::string& path = params->image.value;
    RgbImage file;
    try {
        file = readImage(path);
    } catch (const IoError& e) {
        diagnostics_.error("E0402", params->image.span, e.what(), "cannot be read");
        return;
    }
    built_->facts.files.push_back(path);
    RgbSpace space = file.chromaticities ? file.chromaticities->space() : rgb::rec709;
    for (const auto& [key, word] : params->image.keys)
        if (key == "space") space = findRgbSpace(word).value_or(space);
    std::string reason;
    auto upsampling = makeRgbRadiance(space, reason);
    if (!upsampling) {
        diagnostics_.error("E0403", params->image.span, reason);
        return;
    }
    const bool compensated = built_->render.strategy.word == "mis"; // else its samples must cover everything
    auto light = makeEnvironmentLight(*params, {file.width(), file.height(), std::move(file.rgb)},
                                      std::move(upsampling), compensated, context, diagnostics_);
    if (light && !(light->power() > 0)) {
        diagnostics_.warning("W0602", params->image.span, "this environment is black; the light is left out");
        return;
    }
    addLight(std::move(light), d);
}

std::unique_ptr<const Shape> SceneBuilder::lightShape(const Definition& d, const Transform& toRender,
                                                      AreaLightParams& amount) {
    const std::string_view type = d.type ? d.type->name : "";
    const auto take = [&](const auto& params) {
        amount = params;
        return params.transform.then(toRender);
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
        auto mesh = loadMesh(p->file, tree_.header.length, p->points, p->faces, d.span, diagnostics_, tree_.header.zUp);
        if (!mesh) return nullptr;
        if (!p->file.value.empty()) built_->facts.files.push_back(p->file.value);
        return placeMesh(std::move(*mesh), take(*p), d.span, diagnostics_);
    } else {
        bound<AreaLightParams>(d); // unknown type: report what is wrong besides
    }
    return nullptr;
}

void SceneBuilder::placeAreaLight(const Definition& d, const Transform& toRender) {
    AreaLightParams amount;
    auto shape = lightShape(d, toRender, amount);
    if (!shape) return;
    auto light = makeAreaLight(amount, *shape, lightContext(d, toRender), diagnostics_);
    if (!light) return;
    const Shape* placed = keepShape(std::move(shape));
    const Bounds3 box = placed->bounds();
    bounds_.add(Bounds3d{Vec3d(box.lower), Vec3d(box.upper)});
    embree_.addShape(*placed, {plainMaterial(0), light.get()}); // a lamp emits and reflects nothing
    addLight(std::move(light), d);
}

} // namespace abbe
