#include "scene/build.h"

#include "base/work.h"
#include "film/layer_plan.h"
#include "lights/emitted_spectrum.h"
#include "scene/enclosed_camera.h"
#include "scene/registry.h"
#include "scene/scene_builder.h"
#include "schema/suggest.h"
#include "spectrum/sensor.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace abbe {

using schema::Kind;

SceneBuilder::SceneBuilder(const schema::SceneTree& tree, const schema::TypeTable& types, const BuildOptions& options,
                           Diagnostics& diagnostics)
    : tree_(tree), types_(types), options_(options), diagnostics_(diagnostics) {}

const Curve* SceneBuilder::curve(const schema::SpectrumValue& value, schema::SpectrumRole role, Diagnostics& d) {
    const Curve* const made = curves_.curve(value, role, d);
    return role == schema::SpectrumRole::index ? switchedIndex(made, value.span) : made;
}

schema::ComplexIndex SceneBuilder::metal(std::string_view name, Span span, Diagnostics& d) {
    return curves_.metal(name, span, d);
}

// What has a name is made once, whatever its kind.
schema::Reference SceneBuilder::reference(const Definition& definition, Diagnostics& diagnostics) {
    const auto named = definition.name.empty() ? references_.end() : references_.find(&definition);
    const bool known = named != references_.end();
    const schema::Reference made = known ? named->second : makeReference(definition, diagnostics);
    if (!known && !definition.name.empty()) references_[&definition] = made;
    if (definition.kind == Kind::material && made.valid()) askTextures(made.index);
    return made;
}

schema::Reference SceneBuilder::makeReference(const Definition& definition, Diagnostics& diagnostics) {
    switch (definition.kind) {
    case Kind::material:
        return materialReference(definition);
    case Kind::texture:
        return textureReference(definition, diagnostics);
    case Kind::phase:
        return phaseReference(definition);
    case Kind::medium:
        return mediumReference(definition);
    default:
        return {};
    }
}

std::function<bool(void*)> SceneBuilder::binder(const Definition& definition, Diagnostics& diagnostics) {
    return [this, &definition, &diagnostics](void* params) {
        return schema::bind(definition, tree_, types_, *this, params, diagnostics);
    };
}

const schema::Definition* SceneBuilder::only(Kind kind, std::string_view name) {
    const Definition* first = nullptr;
    for (const Definition& d : tree_.definitions) {
        if (d.kind != kind) continue;
        if (!name.empty() && d.name == name) return &d;
        if (name.empty() && !first)
            first = &d;
        else if (name.empty() && kind != Kind::camera) {
            Diagnostic& e = diagnostics_.error(
                "E0608", d.nameSpan, fmt::format("a scene has one `{}`", schema::keyword(kind)), "second one");
            e.related.push_back({first->nameSpan, "the first one is here"});
        }
    }
    return first;
}

void SceneBuilder::buildSettings(BuiltScene& built) {
    if (const Definition* film = only(Kind::film, ""))
        if (auto params = bound<FilmParams>(*film)) {
            built.film = std::move(*params);
            for (const FilmFault& fault : findFaults(built.film))
                diagnostics_.error(std::string(fault.code), film->span, fault.message, std::string(fault.field)).help =
                    fault.help;
            built.layers = layerPlan(built.film.layers, diagnostics_);
            checkMattes(built);
        }
    if (findFaults(built.film).empty()) built.scene.sensor = makeSensor(built.film);
    if (const Definition* render = only(Kind::render, ""))
        if (const auto params = bound<RenderParams>(*render)) {
            built.render = *params;
            if (!possibleWavelengths(params->wavelengths)) {
                diagnostics_
                    .error("E0711", render->span, fmt::format("a path cannot have {} wavelengths", params->wavelengths),
                           "wavelengths")
                    .help = "1, 2, 4 or 8";
                built.render.wavelengths = 8;
            }
        }
    if (options_.size) {
        built.film.size = {static_cast<double>(options_.size->x), static_cast<double>(options_.size->y)};
        built.film.crop.reset();
    }
    if (options_.samples) built.render.samples = *options_.samples;
    if (options_.seed) built.render.seed = *options_.seed;
    if (options_.noise) built.render.noise = *options_.noise;
    if (options_.timeLimit) built.render.timeLimit = *options_.timeLimit;
    if (options_.textureCache) built.render.textureCache = *options_.textureCache;
    if (options_.adaptive) built.render.adaptive = *options_.adaptive;
    if (!options_.strategy.empty()) built.render.strategy.word = options_.strategy;
    if (!options_.sampler.empty()) built.render.sampler.word = options_.sampler;
}

// Identifiers are the bits of floats, which lossy compression changes.
void SceneBuilder::checkMattes(const BuiltScene& built) {
    if (!built.layers.objects && !built.layers.materials) return;
    for (const auto& [key, value] : built.film.output.keys)
        if (key == "compression" && (value == "pxr24" || value == "dwaa" || value == "dwab"))
            diagnostics_
                .error("E0655", built.film.output.span, fmt::format("compression `{}` would damage Cryptomatte", value))
                .help = "`zip`, `zips` and `piz` lose nothing";
}

void SceneBuilder::checkLightGroups(const BuiltScene& built) {
    std::set<std::string_view> known;
    for (const auto& light : lights_) known.insert(built.scene.names.at(light.get()));
    const std::vector<std::string_view> names(known.begin(), known.end());
    for (const LightGroup& group : built.layers.groups)
        for (const std::string& member : group.members)
            if (!known.contains(member)) {
                const std::string_view near = schema::nearest(member, names);
                diagnostics_
                    .error("E0655", built.film.layers.span, fmt::format("no light is called `{}`", member),
                           fmt::format("in the light group `{}`", group.name))
                    .help = near.empty() ? "give the light a name: `light NAME quad { … }`" : schema::didYouMean(near);
            }
}

void SceneBuilder::finish(BuiltScene& built) {
    built.facts.lights = lights_.size();
    built.facts.materials = materials_.size();
    built.facts.bounds =
        bounds_.empty() ? bounds_ : Bounds3d{bounds_.lower + built.scene.origin, bounds_.upper + built.scene.origin};
    double emitted = 0;
    const Bounds3 box = bounds_.empty() ? Bounds3{} : Bounds3{Vec3(bounds_.lower), Vec3(bounds_.upper)};
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        lights_[i]->commit(box);
        emitted += lights_[i]->power();
        built.facts.lightList.push_back({lightNames_[i].first, lightNames_[i].second, lights_[i]->power()});
    }
    checkLightGroups(built);
    checkLightPathsSeeAll();
    if (!(emitted > 0) && !diagnostics_.hasErrors())
        diagnostics_.error("E0610", tree_.header.span, "the scene has no light", "its picture would be black").help =
            "add one, for example `light sky { luminance 5000 nits }`";
    std::optional<WavelengthDensity::Shown> shown;
    if (const auto& bins = built.layers.spectral) shown = {bins->first, bins->last};
    built.scene.wavelengths = WavelengthDensity::bestFor(emittedSpectrum(lights_), shown);
    noteEffects();
    noteMedia(built.scene);
    checkForbidden();
    checkCompiled();
    if (options_.geometry && !diagnostics_.hasErrors()) {
        const WorkScope work(Work::committing);
        const auto start = std::chrono::steady_clock::now();
        built.scene.intersector = embree_.build();
        built.commitSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    built.scene.curves = curves_.release();
    for (auto& inner : undressed_) materials_.push_back(std::move(inner));
    for (auto& texture : textures_) built.scene.textures.push_back(std::move(texture));
    built.scene.materials = std::move(materials_);
    built.scene.shapes = std::move(shapes_);
    for (auto& light : lights_) built.scene.lights.push_back(std::move(light));
    if (built.scene.intersector && built.scene.camera) checkEnclosure(built.scene);
}

void SceneBuilder::checkEnclosure(const Scene& scene) {
    const Material* const body = darkBodyAroundCamera(scene);
    if (!body) return;
    std::vector<const Shape*> shapes; // of that material
    for (const SurfaceUse& use : scene.surfaces)
        if (use.material == body && use.shape) shapes.push_back(use.shape);
    const auto name = shapes.size() == 1 ? scene.names.find(shapes[0]) : scene.names.end();
    diagnostics_.warning("W0696", cameraSpan_, "the camera is inside of an opaque body", "no light gets here").help =
        name == scene.names.end()
            ? "move the camera or the shape around it: its picture would be black"
            : fmt::format("move the camera out of `{}`: its picture would be black", name->second);
}

void SceneBuilder::build(BuiltScene& built) {
    built_ = &built;
    buildSettings(built);
    buildCamera(built);
    Place scene;
    scene.motion = Motion(Transform::translate(-built.scene.origin));
    placeAll(tree_.definitions, scene);
    // What nothing refers to is checked all the same.
    for (const Definition& d : tree_.definitions) {
        if (d.kind == Kind::material || d.kind == Kind::texture || d.kind == Kind::phase || d.kind == Kind::medium)
            reference(d, diagnostics_);
        if (d.kind == Kind::object) objectGeometry(d);
    }
    finish(built);
}

BuiltScene buildScene(const schema::SceneTree& tree, const schema::TypeTable& types, const BuildOptions& options,
                      Diagnostics& diagnostics) {
    BuiltScene built;
    SceneBuilder(tree, types, options, diagnostics).build(built);
    return built;
}

} // namespace abbe
