#include "geometry/shape_params.h"

#include "geometry/mesh.h"

#include <cmath>

namespace abbe {

bool inReach(Vec3d p) { return isFinite(p) && maxComponent(abs(p)) < kLargestCoordinate; }

void reportOutOfReach(Span span, Diagnostics& diagnostics) {
    diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
}

void reportNoArea(Span span, Diagnostics& diagnostics, const std::string& what) {
    diagnostics.error("E0604", span, "`" + what + "` has no area", "nothing to see here");
}

Transform uprightAt(Vec3d center, Vec3d axis) {
    const Vec3d a = normalize(axis), y{0, 1, 0}, across = cross(y, a);
    const double sine = length(across), angle = std::atan2(sine, dot(y, a));
    const Vec3d hinge = sine > 0 ? across : Vec3d{1, 0, 0};
    return Transform::rotate(hinge, angle).then(Transform::translate(center));
}

bool checkAxis(const std::optional<Vec3d>& axis, const ShapeContext& context) {
    if (!axis || length(*axis) > 0) return true;
    context.diagnostics.error("E0604", context.span, "`axis` has no direction", "its length is 0");
    return false;
}

std::unique_ptr<const Shape> placeMesh(MeshData mesh, const Transform& place, Span span, Diagnostics& diagnostics) {
    for (Vec3& p : mesh.positions) {
        const Vec3d q = place.point(Vec3d(p));
        if (!inReach(q)) return reportOutOfReach(span, diagnostics), nullptr;
        p = Vec3(q);
    }
    // Unit normals become as long as the map makes them, up to one factor for all: the lengths weigh the blend between
    // corners, which is then the same as that of an instance, whose normals are mapped after blending.
    const double size = std::cbrt(square(place.determinant()));
    for (Vec3& n : mesh.normals) {
        const double l = length(Vec3d(n));
        n = l > 0 && size > 0 ? Vec3(place.normal(Vec3d(n) * (1 / l)) * (1 / size)) : Vec3{};
    }
    if (place.determinant() < 0) { // a mirror turns windings: turn them back, so that outside stays outside
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
        for (auto& q : mesh.quads) std::swap(q[1], q[3]);
    }
    return std::make_unique<Mesh>(std::move(mesh), place.determinant() < 0);
}

std::unique_ptr<const Shape>
placeParametric(const Transform& map, const ShapeContext& context,
                const std::function<std::unique_ptr<const Shape>(const Transform&)>& make) {
    if (!map.isFinite() || !map.inverse()) {
        context.diagnostics.error("E0604", context.span, "the shape's transform leaves it no volume", "flattened");
        return nullptr;
    }
    std::unique_ptr<const Shape> shape = make(map);
    const Bounds3 b = shape->bounds();
    if (isFinite(b.lower) && isFinite(b.upper) &&
        std::max(maxComponent(abs(b.lower)), maxComponent(abs(b.upper))) < 1e15f)
        return shape;
    reportOutOfReach(context.span, context.diagnostics);
    return nullptr;
}

} // namespace abbe
