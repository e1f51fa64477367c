#include "scene/scene_motion.h"

#include "geometry/instance_table.h"
#include "scene/shape_deform.h"

#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kSamples = 64; // of the way, for faults and the scene's bounds

} // namespace

bool SceneMotion::moves(const KeyedTransform& transform) const {
    const Interval& shutter = context_.built.shutter;
    return transform.movesDuring(shutter.open, shutter.open + shutter.duration);
}

bool SceneMotion::deforms(std::span<const double> keys) const {
    return gridOf(keys, context_.built.shutter).steps.size() > 1;
}

// Keys that make no difference while the shutter is open cost nothing.
Motion SceneMotion::within(const Motion& outer, const KeyedTransform& own) const {
    return (moves(own) ? Motion().then(own) : Motion(own.at(context_.built.shutter.open))).then(outer);
}

Motion SceneMotion::fromOpening(const Motion& motion) const {
    return Motion(atOpening(motion).inverse().value()).then(motion);
}

bool SceneMotion::check(const Motion& motion, Span where) const {
    for (int i = 0; i <= kSamples; ++i) {
        const double after = context_.built.shutter.duration * i / kSamples;
        const auto fault = Placement::findFault(motion.at(context_.built.shutter.open + after));
        if (!fault) continue;
        context_.diagnostics.error("E0631", where, fmt::format("this place cannot be used: {}", *fault),
                                   fmt::format("{:.6g} s after the shutter opens", after));
        return false;
    }
    return true;
}

Bounds3 SceneMotion::swept(const Motion& motion, const Bounds3& box) const {
    Bounds3 all;
    for (int i = 0; i <= kSamples && !box.empty(); ++i)
        all.add(Placement(motion.at(context_.built.shutter.open + context_.built.shutter.duration * i / kSamples))
                    .toOuter(box));
    return all;
}

bool SceneMotion::ofLight(const Motion& toRender, Span where, std::optional<LightMotion>& result) const {
    if (!toRender.moves()) return true;
    if (!check(toRender, where)) return false;
    context_.noteEffect(Effect::motion, where, "this light moves while the shutter is open");
    const Motion onwards = fromOpening(toRender);
    if (!LightMotion::keepsShape(onwards, context_.built.shutter)) {
        context_.diagnostics
            .error("E0634", where, "a light keeps its shape while the shutter is open",
                   "is stretched on its way, or mirrored")
            .help = "move it, turn it, or scale it evenly in all directions";
        return false;
    }
    result.emplace(onwards, context_.built.shutter);
    return true;
}

} // namespace abbe
