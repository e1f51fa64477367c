#include "geometry/disk.h"
#include "geometry/mesh.h"
#include "geometry/plane.h"
#include "geometry/quad.h"
#include "geometry/sphere.h"
#include "geometry/transformed.h"
#include "scene/shape_types.h"

#include <cmath>

namespace abbe {

namespace {

bool inReach(Vec3d p) { return isFinite(p) && maxComponent(abs(p)) < kLargestCoordinate; }

void outOfReach(Span span, Diagnostics& diagnostics) {
    diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
}

void noArea(Span span, Diagnostics& diagnostics, std::string what) {
    diagnostics.error("E0604", span, "`" + what + "` has no area", "nothing to see here");
}

} // namespace

std::unique_ptr<const Shape> makeQuad(const std::vector<Vec3d>& points, Vec2d size, const Transform& place, Span span,
                                      Diagnostics& diagnostics) {
    if (!points.empty() && points.size() != 4) {
        diagnostics.error("E0603", span, "a quad has four `points`", std::to_string(points.size()) + " given");
        return nullptr;
    }
    std::array<Vec3d, 4> corners;
    const double w = size.x / 2, h = size.y / 2;
    if (points.empty())
        corners = {Vec3d{-w, -h, 0}, {w, -h, 0}, {w, h, 0}, {-w, h, 0}};
    else
        std::copy(points.begin(), points.end(), corners.begin());
    const bool mirrored = place.determinant() < 0; // keep the outer side outside
    if (mirrored) std::swap(corners[1], corners[3]);
    for (Vec3d& p : corners) {
        p = place.point(p);
        if (!inReach(p)) return outOfReach(span, diagnostics), nullptr;
    }
    const Vec3d normal = cross(corners[1] - corners[0], corners[3] - corners[0]) +
                         cross(corners[3] - corners[2], corners[1] - corners[2]);
    const double extent = std::max(lengthSquared(corners[2] - corners[0]), lengthSquared(corners[3] - corners[1]));
    if (!(length(normal) > 1e-12 * extent) || !(extent > 0)) return noArea(span, diagnostics, "quad"), nullptr;
    return std::make_unique<Quad>(Vec3(corners[0]), Vec3(corners[1]), Vec3(corners[2]), Vec3(corners[3]), mirrored);
}

std::unique_ptr<const Shape> makeSphere(Vec3d center, double radius, const Transform& place, Span span,
                                        Diagnostics& diagnostics) {
    const Vec3d c = place.point(center);
    const auto scale = place.uniformScale();
    if (!inReach(c) || (scale && !(*scale * radius < kLargestCoordinate)))
        return outOfReach(span, diagnostics), nullptr;
    if (scale) return std::make_unique<Sphere>(c, *scale * radius, place);
    return std::make_unique<Transformed>(std::make_unique<Sphere>(center, radius), place);
}

std::unique_ptr<const Shape> makeDisk(Vec3d center, Vec3d normal, double radius, const Transform& place, Span span,
                                      Diagnostics& diagnostics) {
    if (!(length(normal) > 0)) return noArea(span, diagnostics, "normal"), nullptr;
    const Vec3d c = place.point(center);
    const auto scale = place.uniformScale();
    if (!inReach(c) || (scale && !(*scale * radius < kLargestCoordinate)))
        return outOfReach(span, diagnostics), nullptr;
    if (scale) return std::make_unique<Disk>(c, normalize(place.normal(normal)), *scale * radius, place);
    return std::make_unique<Transformed>(std::make_unique<Disk>(center, normalize(normal), radius), place);
}

std::unique_ptr<const Shape> makePlane(Vec3d point, Vec3d normal, const Transform& place, Span span,
                                       Diagnostics& diagnostics) {
    if (!(length(normal) > 0)) return noArea(span, diagnostics, "normal"), nullptr;
    const Vec3d p = place.point(point);
    if (!inReach(p)) return outOfReach(span, diagnostics), nullptr;
    return std::make_unique<Plane>(p, normalize(place.normal(normal)), place);
}

std::unique_ptr<const Shape> placeMesh(MeshData mesh, const Transform& place, Span span, Diagnostics& diagnostics) {
    for (Vec3& p : mesh.positions) {
        const Vec3d q = place.point(Vec3d(p));
        if (!inReach(q)) return outOfReach(span, diagnostics), nullptr;
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

} // namespace abbe
