// Shapes in the space that a map leads to, and what keeps them out of it.
#pragma once

#include "geometry/shape_params.h"

namespace abbe {

bool inReach(Vec3d p);
// E0605 and E0604.
void reportOutOfReach(Span, Diagnostics&);
void reportNoArea(Span, Diagnostics&, const std::string& what);

// Turns the y axis to `axis`, moves the origin to `center`. Requires axis != 0.
Transform uprightAt(Vec3d center, Vec3d axis);
// Whether an axis, if there is one, has a direction; false after an error.
bool checkAxis(const std::optional<Vec3d>&, const ShapeContext&);

// A mesh whose outer side stays outside under mirrors. Null after an error located at `span`.
std::unique_ptr<const Shape> placeMesh(MeshData, const Transform& place, Span, Diagnostics&);

// Calls make(map) for a shape that any map but a flat one can place; null after an error: the map flattens the shape or
// moves it too far away.
std::unique_ptr<const Shape> placeParametric(const Transform& map, const ShapeContext&,
                                             const std::function<std::unique_ptr<const Shape>(const Transform&)>& make);

} // namespace abbe
