// Where the shapes of a scene are, for `abbe info`.
#include "scene/scene_builder.h"

namespace abbe {

// Boxes in objects stay in the object's space, which its instances place; all others are those when the shutter opens.
void SceneBuilder::noteBounds(const Definition& d, const Bounds3& box, const Place& place, std::size_t places) {
    SceneFacts::ShapeFact fact;
    const bool placement = d.kind == schema::Kind::instance || d.kind == schema::Kind::instances;
    fact.kind = schema::keyword(d.kind);
    fact.name = placement ? d.target : nameOf(d);
    if (d.type) fact.type = d.type->name;
    fact.places = places;
    if (place.object && !chain_.empty()) fact.inside = chain_.back()->name;
    if (!box.empty()) {
        const Vec3d origin = place.object ? Vec3d() : built_->scene.origin;
        fact.bounds = {Vec3d(box.lower) + origin, Vec3d(box.upper) + origin};
    }
    built_->facts.shapeList.push_back(std::move(fact));
}

} // namespace abbe
