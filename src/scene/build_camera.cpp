// The camera, and what its focus may be measured to.
#include "base/check.h"
#include "cameras/shutter_camera.h"
#include "scene/registry.h"
#include "scene/scene_builder.h"

#include <fmt/format.h>

namespace abbe {

using schema::Kind;

// Looks through groups, whose transforms add up to `place`; the parts of objects have many places or none.
const schema::Definition* SceneBuilder::findShape(const std::vector<Definition>& definitions, std::string_view name,
                                                  double time, Transform& place) {
    for (const Definition& d : definitions) {
        if (d.kind == Kind::shape && d.name == name) return &d;
        if (d.kind != Kind::group) continue;
        if (const Definition* found = findShape(d.children, name, time, place)) {
            Diagnostics again; // what is wrong with the transform is reported when the group is placed
            for (const schema::Node& property : d.properties)
                if (property.name() == "transform")
                    place = place.then(schema::bindMotion(property, tree_.header, again).at(time));
            return found;
        }
    }
    return nullptr;
}

std::optional<Vec3d> SceneBuilder::middleOfShape(std::string_view name, double time) {
    Transform toWorld;
    const Definition* d = findShape(tree_.definitions, name, time, toWorld);
    if (!d) return std::nullopt;
    LoadedShape& loaded = loadedShape(*d);
    if (!loaded.sound || loaded.infinite) return std::nullopt;
    const Transform place = loaded.common.transform.at(time).then(toWorld);
    Bounds3d box;
    if (loaded.mesh) {
        for (const Vec3& p : loaded.mesh->positions) box.add(place.point(loaded.meshOrigin + Vec3d(p)));
    } else if (const auto shape = loaded.place(place)) {
        box = {Vec3d(shape->bounds().lower), Vec3d(shape->bounds().upper)};
    }
    return box.empty() ? std::nullopt : std::optional((box.lower + box.upper) / 2);
}

void SceneBuilder::buildCamera(BuiltScene& built) {
    const Definition* definition = only(Kind::camera, options_.camera);
    if (!definition) {
        diagnostics_
            .error("E0601", tree_.header.span,
                   options_.camera.empty() ? std::string("the scene has no camera")
                                           : fmt::format("no camera is named `{}`", options_.camera))
            .help = "add one, for example `camera { from 0 1 4; look-at 0 0.5 0; exposure auto }`";
        return;
    }
    cameraSpan_ = definition->span;
    const auto bindInto = binder(*definition, diagnostics_);
    if (!definition->type) {
        bindInto(nullptr);
        return;
    }
    CameraContext context;
    context.zUp = tree_.header.zUp;
    context.filmSize = {static_cast<int>(built.film.size.x), static_cast<int>(built.film.size.y)};
    context.span = definition->span;
    context.middleOf = [this](std::string_view name, double time) { return middleOfShape(name, time); };
    auto placed = makeCamera(definition->type->name, bindInto, context, diagnostics_);
    if (!placed) return;
    built.scene.camera = std::move(placed->camera);
    built.scene.frame = {0, 0, context.filmSize.x, context.filmSize.y};
    built.scene.origin = placed->origin;
    built.cameraExposure = placed->exposure;
    built.exposure = placed->exposure.factor();
    built.cameraSpan = definition->span;
    const Shutter& shutter = placed->shutter;
    built.shutter = {shutter.open, shutter.duration()};
    if (placed->toWorld.moves() || shutter.opening + shutter.closing > 0)
        built.scene.camera = std::make_unique<ShutterCamera>(
            std::move(built.scene.camera), placed->toWorld.then(Transform::translate(-placed->origin)), shutter);
    switchCamera(built, *definition);
    embree_.setShutter(built.shutter.open, built.shutter.duration);
    if (built.scene.camera->disperses())
        noteEffect(Effect::dispersion, definition->span, "the glass of its lens disperses");
    if (built.scene.camera->usesLens()) noteEffect(Effect::depthOfField, definition->span, "its lens has a width");
    if (placed->toWorld.moves() && built.shutter.duration > 0)
        noteEffect(Effect::motion, definition->span, "the camera moves");
}

} // namespace abbe
