// What moves while the shutter is open is built where it is when the shutter opens, and carried on from there as one
// instance.
#include "geometry/instance_table.h"
#include "scene/placer.h"

#include <fmt/format.h>

namespace abbe {

void Placer::carry(const KeyedTransform& own, const Place& outer, Span asker,
                   const std::function<void(const Place&)>& build) {
    Place place = outer;
    place.motion = motion_.within(outer.motion, own);
    if (!place.motion.moves() || (outer.into != outer.base && !motion_.moves(own))) return build(place);
    if (!motion_.check(place.motion, asker)) return;
    context_.noteEffect(Effect::motion, asker, "it moves while the shutter is open");
    const Motion onwards = motion_.fromOpening(place.motion);
    if (!motion_.check(onwards, asker)) return;
    Assembly carried;
    place.into = &carried;
    build(place);
    if (carried.shapes.empty() && carried.placed.empty()) return;
    const Bounds3 bounds = carried.bounds;
    const std::vector<FocusingShape> focusing = std::move(carried.focusing);
    const int levels = carried.levels;
    addMoving(addAssembly(std::move(carried)), levels, bounds, focusing, onwards, outer.base, asker);
}

std::uint32_t Placer::addAssembly(Assembly parts) {
    const std::uint32_t number = embree.addObject(std::move(parts.shapes));
    for (auto& [object, places, visible] : parts.placed)
        embree.addInstances(object, std::move(places), number, visible);
    for (const auto& [object, motion, visible] : parts.moving) embree.addMoving(object, motion, number, visible);
    return number;
}

void Placer::addMoving(std::uint32_t object, int levels, const Bounds3& bounds,
                       const std::vector<FocusingShape>& focusing, const Motion& motion, Assembly* into, Span asker,
                       Visibility visible) {
    const Bounds3 box = motion_.swept(motion, bounds);
    for (const FocusingShape& shape : focusing)
        focusingIn(into).push_back({motion_.swept(motion, shape.box), shape.name});
    if (!into) {
        if (!box.empty()) extend(box);
        embree.addMoving(object, motion, EmbreeSceneBuilder::kScene, visible);
    } else if (nest(*into, levels, asker)) {
        into->bounds.add(box);
        into->moving.push_back({object, motion, visible});
    }
}

bool Placer::nest(Assembly& into, int levels, Span asker) {
    if (levels + 2 > kMaxInstanceLevels) return tooDeep(asker), false; // the scene itself is one more
    into.levels = std::max(into.levels, levels + 1);
    return true;
}

void Placer::tooDeep(Span asker) {
    context_.diagnostics.error("E0633", asker, fmt::format("objects nest more than {} levels deep", kMaxInstanceLevels),
                               "this one is too deep");
}

} // namespace abbe
