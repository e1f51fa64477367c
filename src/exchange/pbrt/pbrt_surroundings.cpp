// The media around shapes of pbrt scenes, and the one around the camera.
#include "exchange/pbrt/pbrt_shapes.h"

#include <fmt/format.h>

namespace abbe::exchange {

namespace {

Bounds3d movedBox(const Bounds3d& box, const Transform& map) {
    Bounds3d moved;
    for (int i = 0; i < 8; ++i)
        moved.add(map.point(
            {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y, i & 4 ? box.upper.z : box.lower.z}));
    return moved;
}

} // namespace

void PbrtShapes::noteMedia(const Making& m, bool isFilled) {
    const PbrtMaterial* const material = m.material;
    if (material && !material->isInterface && material->hasInterior) return; // its inside is its own
    FilledShape shape;
    shape.name = fmt::format("a shape `{}`", m.type);
    shape.span = m.params.directive;
    shape.surface = material && material->isInterface   ? FilledShape::Surface::boundary
                    : material && material->lightEnters ? FilledShape::Surface::dielectric
                                                        : FilledShape::Surface::opaque;
    shape.inside = mediumId(m.state.inside);
    shape.outside = mediumId(m.state.outside);
    shape.isFilled = isFilled && shape.surface != FilledShape::Surface::opaque;
    if (shape.surface == FilledShape::Surface::boundary && !shape.inside) return; // a hole, which is said
    if (!inObject_ && !m.box.empty()) shape.box = movedBox(m.box, m.state.place.at[0]);
    nesting_.note(std::move(shape));
}

bool PbrtShapes::placeMedia(const std::string& around, Vec3d eye) {
    const void* const medium = mediumId(around);
    const bool isEverywhere = medium && !nesting_.isHeldAt(medium, eye);
    nesting_.report(isEverywhere ? medium : nullptr, "the outer medium", shared_.out);
    return isEverywhere;
}

} // namespace abbe::exchange
