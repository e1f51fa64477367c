#include "scene/camera_builder.h"

#include "cameras/held_camera.h"
#include "cameras/shutter_camera.h"
#include "scene/registry.h"

#include <fmt/format.h>

namespace abbe {

using schema::Kind;

// Looks through groups, whose transforms add up to `place`; the parts of objects have many places or none.
const schema::Definition* CameraBuilder::findShape(const std::vector<Definition>& definitions, std::string_view name,
                                                   double time, Transform& place) {
    for (const Definition& d : definitions) {
        if (d.kind == Kind::shape && d.name == name) return &d;
        if (d.kind != Kind::group) continue;
        if (const Definition* found = findShape(d.children, name, time, place)) {
            Diagnostics again; // what is wrong with the transform is reported when the group is placed
            for (const schema::Node& property : d.properties)
                if (property.name() == "transform")
                    place = place.then(schema::bindMotion(property, context_.tree.header, again).at(time));
            return found;
        }
    }
    return nullptr;
}

std::optional<Vec3d> CameraBuilder::middleOfShape(std::string_view name, double time) {
    Transform toWorld;
    const Definition* d = findShape(context_.tree.definitions, name, time, toWorld);
    if (!d) return std::nullopt;
    LoadedShape& loaded = shapes_.loaded(*d);
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

CameraContext CameraBuilder::contextOf(const Definition& d) {
    CameraContext camera;
    camera.zUp = context_.tree.header.zUp;
    camera.filmSize = {static_cast<int>(context_.built.film.size.x), static_cast<int>(context_.built.film.size.y)};
    camera.span = d.span;
    camera.middleOf = [this](std::string_view name, double time) { return middleOfShape(name, time); };
    return camera;
}

void CameraBuilder::build() {
    BuiltScene& built = context_.built;
    const Definition* definition = context_.only(Kind::camera, context_.options.camera);
    if (!definition) {
        context_.diagnostics
            .error("E0601", context_.tree.header.span,
                   context_.options.camera.empty() ? std::string("the scene has no camera")
                                                   : fmt::format("no camera is named `{}`", context_.options.camera))
            .help = "add one, for example `camera { from 0 1 4; look-at 0 0.5 0; exposure auto }`";
        return;
    }
    built.cameraSpan = definition->span;
    const auto bindInto = context_.binder(*definition, context_.diagnostics);
    if (!definition->type) {
        bindInto(nullptr);
        return;
    }
    const CameraContext camera = contextOf(*definition);
    auto placed = makerOf<MakeCamera>(*definition->type)(bindInto, camera, context_.diagnostics);
    if (!placed) return;
    built.scene.camera = std::move(placed->camera);
    built.scene.frame = {0, 0, camera.filmSize.x, camera.filmSize.y};
    built.scene.origin = placed->origin;
    built.cameraExposure = placed->exposure;
    built.exposure = placed->exposure.factor();
    const Shutter& shutter = placed->shutter;
    built.shutter = {shutter.open, shutter.duration()};
    if (placed->toWorld.moves() || shutter.opening + shutter.closing > 0)
        built.scene.camera = std::make_unique<ShutterCamera>(
            std::move(built.scene.camera), placed->toWorld.then(Transform::translate(-placed->origin)), shutter);
    leaveOutEffects(*definition);
    if (built.scene.camera->disperses())
        context_.noteEffect(Effect::dispersion, definition->span, "the glass of its lens disperses");
    if (built.scene.camera->usesLens())
        context_.noteEffect(Effect::depthOfField, definition->span, "its lens has a width");
    if (placed->toWorld.moves() && built.shutter.duration > 0)
        context_.noteEffect(Effect::motion, definition->span, "the camera moves");
}

// Before anything is placed; the shutter of the scene is known.
void CameraBuilder::leaveOutEffects(const Definition& camera) {
    BuiltScene& built = context_.built;
    const bool centred =
        built.scene.camera->usesLens() && context_.leavesOut({SwitchedEffect::depthOfField}, camera.span);
    const bool still = context_.options.without.leavesOut(SwitchedEffect::motion);
    if (still) built.shutter = {built.shutter.open + built.shutter.duration / 2, 0};
    if (centred || still)
        built.scene.camera = std::make_unique<HeldCamera>(std::move(built.scene.camera), centred, still);
}

} // namespace abbe
