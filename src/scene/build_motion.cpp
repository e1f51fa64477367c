// What moves while the shutter is open: it is built where it is when the shutter opens, and carried on from there as
// one instance.
#include "geometry/instance_table.h"
#include "scene/scene_builder.h"
#include "scene/shape_deform.h"

#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kSamples = 64; // of the way, for faults and the scene's bounds

} // namespace

bool SceneBuilder::moves(const KeyedTransform& transform) const {
    const Interval& shutter = built_->shutter;
    return transform.movesDuring(shutter.open, shutter.open + shutter.duration);
}

bool SceneBuilder::deforms(std::span<const double> keys) const {
    return gridOf(keys, built_->shutter).steps.size() > 1;
}

// Keys that make no difference while the shutter is open cost nothing.
Motion SceneBuilder::within(const Motion& outer, const KeyedTransform& own) const {
    return (moves(own) ? Motion().then(own) : Motion(own.at(built_->shutter.open))).then(outer);
}

Motion SceneBuilder::fromOpening(const Motion& motion) const {
    return Motion(atOpening(motion).inverse().value()).then(motion);
}

bool SceneBuilder::checkMotion(const Motion& motion, Span asker) {
    for (int i = 0; i <= kSamples; ++i) {
        const double after = built_->shutter.duration * i / kSamples;
        const auto fault = Placement::findFault(motion.at(built_->shutter.open + after));
        if (!fault) continue;
        diagnostics_.error("E0631", asker, fmt::format("this place cannot be used: {}", *fault),
                           fmt::format("{:.6g} s after the shutter opens", after));
        return false;
    }
    return true;
}

Bounds3 SceneBuilder::swept(const Motion& motion, const Bounds3& box) const {
    Bounds3 all;
    for (int i = 0; i <= kSamples && !box.empty(); ++i)
        all.add(Placement(motion.at(built_->shutter.open + built_->shutter.duration * i / kSamples)).toOuter(box));
    return all;
}

// Builds what has a transform of its own in the place around it, or, if that moves, in an assembly that is then set
// going. What moves in something that moves is set going by itself, with both motions.
void SceneBuilder::carry(const KeyedTransform& own, const Place& outer, Span asker,
                         const std::function<void(const Place&)>& build) {
    Place place = outer;
    place.motion = within(outer.motion, own);
    if (!place.motion.moves() || (outer.into != outer.base && !moves(own))) return build(place);
    if (!checkMotion(place.motion, asker)) return;
    noteEffect(Effect::motion, asker, "it moves while the shutter is open");
    const Motion onwards = fromOpening(place.motion);
    if (!checkMotion(onwards, asker)) return;
    Assembly carried;
    place.into = &carried;
    build(place);
    if (carried.shapes.empty() && carried.placed.empty()) return;
    const Bounds3 bounds = carried.bounds;
    const std::vector<FocusingShape> focusing = std::move(carried.focusing);
    const int levels = carried.levels;
    addMoving(addAssembly(std::move(carried)), levels, bounds, focusing, onwards, outer.base, asker);
}

std::uint32_t SceneBuilder::addAssembly(Assembly parts) {
    const std::uint32_t number = embree_.addObject(std::move(parts.shapes));
    for (auto& [object, places, visible] : parts.placed)
        embree_.addInstances(object, std::move(places), number, visible);
    for (const auto& [object, motion, visible] : parts.moving) embree_.addMoving(object, motion, number, visible);
    return number;
}

void SceneBuilder::addMoving(std::uint32_t object, int levels, const Bounds3& bounds,
                             const std::vector<FocusingShape>& focusing, const Motion& motion, Assembly* into,
                             Span asker, Visibility visible) {
    const Bounds3 box = swept(motion, bounds);
    for (const FocusingShape& shape : focusing) focusingIn(into).push_back({swept(motion, shape.box), shape.name});
    if (!into) {
        if (!box.empty()) bounds_.add(Bounds3d{Vec3d(box.lower), Vec3d(box.upper)});
        embree_.addMoving(object, motion, EmbreeSceneBuilder::kScene, visible);
    } else if (nest(*into, levels, asker)) {
        into->bounds.add(box);
        into->moving.push_back({object, motion, visible});
    }
}

bool SceneBuilder::nest(Assembly& into, int levels, Span asker) {
    if (levels + 2 > kMaxInstanceLevels) return tooDeep(asker), false; // the scene itself is one more
    into.levels = std::max(into.levels, levels + 1);
    return true;
}

void SceneBuilder::tooDeep(Span asker) {
    diagnostics_.error("E0633", asker, fmt::format("objects nest more than {} levels deep", kMaxInstanceLevels),
                       "this one is too deep");
}

bool SceneBuilder::lightMotion(const Motion& toRender, Span asker, std::optional<LightMotion>& result) {
    if (!toRender.moves()) return true;
    if (!checkMotion(toRender, asker)) return false;
    noteEffect(Effect::motion, asker, "this light moves while the shutter is open");
    const Motion onwards = fromOpening(toRender);
    if (!LightMotion::keepsShape(onwards, built_->shutter)) {
        diagnostics_
            .error("E0634", asker, "a light keeps its shape while the shutter is open",
                   "is stretched on its way, or mirrored")
            .help = "move it, turn it, or scale it evenly in all directions";
        return false;
    }
    result.emplace(onwards, built_->shutter);
    return true;
}

} // namespace abbe
