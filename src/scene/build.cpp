#include "scene/build.h"

#include "base/work.h"
#include "film/layer_plan.h"
#include "lights/amount.h"
#include "scene/camera_builder.h"
#include "scene/instance_builder.h"
#include "scene/light_builder.h"
#include "scene/material_builder.h"
#include "scene/medium_builder.h"
#include "scene/placer.h"
#include "scene/shape_builder.h"
#include "scene/texture_builder.h"
#include "spectrum/sensor.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

using schema::Kind;

namespace {

constexpr double kHeliumLine = 587.6; // nm, the d line, to which indices of glasses refer

// The work of buildScene(): a builder for each kind of definition, made one after the other over those that it needs,
// and the answers to what definitions refer to.
class SceneBuilder final : public schema::Resolver {
  public:
    using Definition = schema::Definition;

    SceneBuilder(const schema::SceneTree& tree, const schema::TypeTable& types, const BuildOptions& options,
                 Diagnostics& diagnostics, BuiltScene& built, SceneReuse* reuse)
        : context_(tree, types, options, diagnostics, built, *this, reuse) {}

    void build();
    void note(InstancePlaces& places) { context_.instancePlaces = &places; }
    void buildCameraAlone() {
        buildSettings();
        cameras_.build();
    }

    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&) override;
    schema::ComplexIndex metal(std::string_view name, Span span, Diagnostics& d) override {
        return context_.curves.metal(name, span, d);
    }
    schema::Reference reference(const Definition&, Diagnostics&) override;
    const Texture* texture(const schema::TextureRequest&, Diagnostics&) override;

  private:
    schema::Reference makeReference(const Definition&, Diagnostics&);
    void buildSettings();
    void checkMattes();
    void commitLights();
    void commitGeometry();
    void checkEnclosure();
    void finish();

    BuildContext context_;
    SceneMotion motion_{context_};
    TextureBuilder textures_{context_};
    PhaseBuilder phases_{context_};
    MediumBuilder media_{context_, phases_};
    MaterialBuilder materials_{context_, textures_, media_};
    ShapeBuilder shapes_{context_, motion_, textures_, media_, materials_, cameras_};
    CameraBuilder cameras_{context_, shapes_};
    LightBuilder lights_{context_, motion_, textures_, shapes_};
    Placer placer_{context_, motion_, media_, materials_, shapes_, lights_, instances_};
    InstanceBuilder instances_{context_, motion_, shapes_, placer_};
    std::unordered_map<const Definition*, schema::Reference> references_; // of what has a name
};

const Curve* SceneBuilder::curve(const schema::SpectrumValue& value, schema::SpectrumRole role, Diagnostics& d) {
    const Curve* const made = context_.curves.curve(value, role, d);
    const bool disperses = role == schema::SpectrumRole::index && made && !made->isConstant();
    if (!disperses || !context_.leavesOut({SwitchedEffect::dispersion}, value.span)) return made;
    return context_.curves.constant(made->at(kHeliumLine));
}

// What has a name is made once, whatever its kind.
schema::Reference SceneBuilder::reference(const Definition& definition, Diagnostics& diagnostics) {
    const auto named = definition.name.empty() ? references_.end() : references_.find(&definition);
    const bool known = named != references_.end();
    const schema::Reference made = known ? named->second : makeReference(definition, diagnostics);
    if (!known && !definition.name.empty()) references_[&definition] = made;
    if (definition.kind == Kind::material && made.valid()) textures_.usePart(made.index);
    return made;
}

schema::Reference SceneBuilder::makeReference(const Definition& definition, Diagnostics& diagnostics) {
    switch (definition.kind) {
    case Kind::material:
        return materials_.reference(definition);
    case Kind::texture:
        return textures_.reference(definition, diagnostics);
    case Kind::phase:
        return phases_.reference(definition);
    case Kind::medium:
        return media_.reference(definition);
    default:
        return {};
    }
}

const Texture* SceneBuilder::texture(const schema::TextureRequest& request, Diagnostics& diagnostics) {
    return textures_.requested(reference(request.definition, diagnostics), request);
}

void SceneBuilder::buildSettings() {
    BuiltScene& built = context_.built;
    if (const Definition* film = context_.only(Kind::film, ""))
        if (auto params = context_.bound<FilmParams>(*film)) {
            built.film = std::move(*params);
            for (const FilmFault& fault : findFaults(built.film))
                context_.diagnostics.error(std::string(fault.code), film->span, fault.message, std::string(fault.field))
                    .help = fault.help;
            built.layers = layerPlan(built.film.layers, context_.diagnostics);
            checkMattes();
        }
    if (findFaults(built.film).empty()) built.scene.sensor = makeSensor(built.film);
    if (const Definition* render = context_.only(Kind::render, ""))
        if (const auto params = context_.bound<RenderParams>(*render)) {
            built.render = *params;
            if (!possibleWavelengths(params->wavelengths)) {
                context_.diagnostics
                    .error("E0711", render->span, fmt::format("a path cannot have {} wavelengths", params->wavelengths),
                           "wavelengths")
                    .help = "1, 2, 4 or 8";
                built.render.wavelengths = 8;
            }
        }
    if (context_.options.size) {
        built.film.size = {static_cast<double>(context_.options.size->x),
                           static_cast<double>(context_.options.size->y)};
        built.film.crop.reset();
    }
    if (context_.options.samples) built.render.samples = *context_.options.samples;
    if (context_.tree.frame) built.render.seed = seedOfFrame(built.render.seed, *context_.tree.frame);
    if (context_.options.seed) built.render.seed = *context_.options.seed;
    if (context_.options.fps) built.render.fps = *context_.options.fps;
    if (context_.options.noise) built.render.noise = *context_.options.noise;
    if (context_.options.timeLimit) built.render.timeLimit = *context_.options.timeLimit;
    if (context_.options.textureCache) built.render.textureCache = *context_.options.textureCache;
    if (context_.options.adaptive) built.render.adaptive = *context_.options.adaptive;
    if (context_.options.strategy) built.render.strategy = *context_.options.strategy;
    if (context_.options.sampler) built.render.sampler = *context_.options.sampler;
}

// Identifiers are the bits of floats, which lossy compression changes.
void SceneBuilder::checkMattes() {
    const BuiltScene& built = context_.built;
    if (!built.layers.objects && !built.layers.materials) return;
    for (const auto& [key, value] : built.film.output.keys)
        if (key == "compression" && (value == "pxr24" || value == "dwaa" || value == "dwab"))
            context_.diagnostics
                .error("E0655", built.film.output.span, fmt::format("compression `{}` would damage Cryptomatte", value))
                .help = "`zip`, `zips` and `piz` lose nothing";
}

void SceneBuilder::commitLights() {
    BuiltScene& built = context_.built;
    const Bounds3d& bounds = placer_.bounds();
    const double emitted = lights_.commit(bounds.empty() ? Bounds3{} : Bounds3{Vec3(bounds.lower), Vec3(bounds.upper)});
    lights_.checkGroups();
    placer_.checkLightPathsSeeAll();
    if (!(emitted > 0) && !context_.diagnostics.hasErrors())
        context_.diagnostics
            .error("E0610", context_.tree.header.span, "the scene has no light", "its picture would be black")
            .help = "add one, for example `light sky { luminance 5000 nits }`";
    std::optional<WavelengthDensity::Shown> shown;
    if (const auto& bins = built.layers.spectral) shown = {bins->first, bins->last};
    built.scene.wavelengths = WavelengthDensity::bestFor(emittedSpectrum(lights_.all()), shown);
}

void SceneBuilder::commitGeometry() {
    if (!context_.options.geometry || context_.diagnostics.hasErrors()) return;
    const WorkScope work(Work::committing);
    const auto start = std::chrono::steady_clock::now();
    context_.built.scene.intersector =
        context_.reuse ? placer_.embree.build(context_.reuse->geometry, shapes_.all()) : placer_.embree.build();
    context_.built.commitSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void SceneBuilder::finish() {
    BuiltScene& built = context_.built;
    Scene& scene = built.scene;
    const Bounds3d& bounds = placer_.bounds();
    built.facts.lights = lights_.all().size();
    built.facts.materials = materials_.count();
    built.facts.bounds = bounds.empty() ? bounds : Bounds3d{bounds.lower + scene.origin, bounds.upper + scene.origin};
    if (context_.reuse) context_.reuse->reach = bounds.empty() ? 0 : length(bounds.upper - bounds.lower);
    commitLights();
    textures_.noteEffects();
    materials_.noteEffects();
    const Bounds3 extent{Vec3(bounds.lower), Vec3(bounds.upper)};
    media_.finish(bounds.empty() ? nullptr : &extent);
    scene.boundaries = scene.nested || materials_.boundaries();
    placer_.embree.setNested(scene.nested);
    context_.checkForbidden();
    context_.checkCompiled();
    commitGeometry();
    if (scene.intersector) lights_.findWindows();
    scene.curves = context_.curves.release();
    for (auto& texture : textures_.release()) scene.textures.push_back(std::move(texture));
    scene.materials = materials_.release();
    scene.shapes = shapes_.release();
    for (auto& light : lights_.release()) scene.lights.push_back(std::move(light));
    if (scene.intersector) noteLightsInside(scene);
    if (scene.intersector && scene.camera) checkEnclosure();
}

void SceneBuilder::checkEnclosure() {
    const Scene& scene = context_.built.scene;
    const Material* const body = darkBodyAroundCamera(scene);
    if (!body) return;
    std::vector<const Shape*> shapes; // of that material
    for (const SurfaceUse& use : scene.surfaces)
        if (use.material == body && use.shape) shapes.push_back(use.shape);
    const auto name = shapes.size() == 1 ? scene.names.find(shapes[0]) : scene.names.end();
    context_.diagnostics
        .warning("W0696", context_.built.cameraSpan, "the camera is inside of an opaque body", "no light gets here")
        .help = name == scene.names.end()
                    ? "move the camera or the shape around it: its picture would be black"
                    : fmt::format("move the camera out of `{}`: its picture would be black", name->second);
}

void SceneBuilder::build() {
    context_.noteInserts();
    buildSettings();
    cameras_.build();
    placer_.embree.setShutter(context_.built.shutter.open, context_.built.shutter.duration);
    Place scene;
    scene.motion = Motion(Transform::translate(-context_.built.scene.origin));
    placer_.placeAll(context_.tree.definitions, scene);
    // What nothing refers to is checked all the same.
    for (const Definition& d : context_.tree.definitions) {
        if (d.kind == Kind::material || d.kind == Kind::texture || d.kind == Kind::phase || d.kind == Kind::medium)
            reference(d, context_.diagnostics);
        if (d.kind == Kind::object) instances_.object(d);
    }
    finish();
}

} // namespace

BuiltScene buildScene(const schema::SceneTree& tree, const schema::TypeTable& types, const BuildOptions& options,
                      Diagnostics& diagnostics, SceneReuse* reuse) {
    BuiltScene built;
    Diagnostics found = diagnostics; // what is wrong so far counts
    const std::size_t known = found.all().size();
    const auto start = std::chrono::steady_clock::now();
    if (reuse) reuse->begin();
    SceneBuilder(tree, types, options, found, built, reuse).build();
    if (reuse)
        reuse->end(!found.hasErrors(), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (tree.includes.empty())
        diagnostics = std::move(found);
    else
        addWithIncluders(tree, found, known, diagnostics);
    return built;
}

InstancePlaces findInstancePlaces(const schema::SceneTree& tree, const schema::TypeTable& types) {
    InstancePlaces places;
    BuildOptions options;
    options.geometry = false;
    Diagnostics repeated; // what is wrong has been told by who built the scene before
    BuiltScene built;
    SceneBuilder builder(tree, types, options, repeated, built, nullptr);
    builder.note(places);
    builder.build();
    return places;
}

LoneCamera buildCamera(const schema::SceneTree& tree, const schema::TypeTable& types, const BuildOptions& options,
                       Diagnostics& diagnostics) {
    BuiltScene built;
    SceneBuilder(tree, types, options, diagnostics, built, nullptr).buildCameraAlone();
    return {std::move(built.scene.camera), built.scene.origin, built.cameraPose};
}

} // namespace abbe
