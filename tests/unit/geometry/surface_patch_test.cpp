// Patches of surfaces: where a line meets them, to double, and how their normals turn there, against differences.
#include "geometry/flat_shapes.h"
#include "geometry/frustum.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "geometry/torus.h"
#include "shape_test_support.h"
#include "test_meshes.h"

#include <doctest/doctest.h>
#include <string>

namespace abbe::test {
namespace {

struct PatchReport {
    int hits = 0;
    double offLine = 0, offHit = 0, normal = 0, change = 0; // the worst
    double curved = 0;                                      // largest |dn| per m
};

// Lines at the shape from a ball of radius 3 about the origin. `step`: m between the neighbours whose normals are
// compared.
PatchReport study(const Shape& shape, double step, int lines = 400) {
    const auto world = intersectorOf(shape);
    Random random(7);
    PatchReport report;
    const auto meet = [&](Vec3d o, Vec3d d, SurfaceHit& hit) {
        const Vec3 w = normalize(Vec3(d));
        return world->intersect({Vec3(o), w}, hit) ? shape.patch(hit, o, d) : std::nullopt;
    };
    const auto ball = [&] {
        Vec3d p;
        do p = {2 * random.uniformDouble() - 1, 2 * random.uniformDouble() - 1, 2 * random.uniformDouble() - 1};
        while (lengthSquared(p) > 1);
        return p;
    };
    for (int i = 0; i < lines; ++i) {
        const Vec3d o = normalize(ball()) * 3.0, d = normalize(ball() - o), across = tangentsOf(d).first;
        SurfaceHit hit, next, before;
        const auto a = meet(o, d, hit);
        const auto b = meet(o + across * step, d, next), c = meet(o - across * step, d, before);
        if (!a || !b || !c || next.primitive != hit.primitive || before.primitive != hit.primitive) continue;
        if (std::abs(dot(d, a->ng)) < 0.3) continue; // the differences say little
        if (dot(a->ng, b->ng) < 0.9 || lengthSquared(b->p - a->p) > 1e4 * step * step) continue; // another face
        if (dot(hit.ng, next.ng) < 0.9) continue;
        ++report.hits;
        const Vec3d e = a->p - o;
        report.offLine = std::max(report.offLine, length(e - d * dot(e, d)));
        report.offHit = std::max(report.offHit, length(a->p - Vec3d(hit.p)));
        report.normal = std::max({report.normal, length(a->n - Vec3d(hit.shading.z)), length(a->ng - Vec3d(hit.ng))});
        const Vec3d seen = (b->n - c->n) / length(b->p - c->p),
                    stated = a->normalChange(b->p - c->p) / length(b->p - c->p);
        report.change = std::max(report.change, length(seen - stated));
        report.curved = std::max(report.curved, length(stated));
    }
    return report;
}

Transform skewed() {
    Transform t = Transform::scale({1, 0.6, 1.4}).then(Transform::rotate({1, 2, 3}, 0.7));
    t.t = {0.1, -0.2, 0.05};
    return t;
}

MeshData smoothBall(bool normals) {
    MeshData data = icosphere(2, {0, 0, 0}, 1);
    if (normals)
        for (const Vec3& p : data.positions) data.normals.push_back(normalize(p) * 1.3f);
    return data;
}

} // namespace

TEST_CASE("a patch lies on the line and on the surface, and its normals turn as those of its neighbours") {
    struct Case {
        std::string name;
        std::unique_ptr<const Shape> shape;
        double curved; // the largest curvature, at least about; 0: flat
    };
    std::vector<Case> cases;
    const Transform t = skewed();
    cases.push_back({"sphere", std::make_unique<Sphere>(Vec3d{0.1, 0.2, 0.3}, 0.8), 1.25});
    cases.push_back(
        {"ellipsoid", std::make_unique<Transformed>(std::make_unique<const Sphere>(Vec3d{0, 0, 0}, 1.0), t), 1.5});
    cases.push_back({"torus", std::make_unique<Torus>(0.8, 0.3, Transform{}), 3});
    cases.push_back({"skewed torus", std::make_unique<Torus>(0.8, 0.3, t), 3});
    cases.push_back({"cylinder", std::make_unique<Frustum>(0.5, 0.5, 1.5, true, Transform{}), 1.9});
    cases.push_back({"skewed cone", std::make_unique<Frustum>(0.9, 0.2, 1.5, true, t), 1});
    cases.push_back({"smooth mesh", std::make_unique<Mesh>(smoothBall(true)), 0.9});
    cases.push_back({"flat mesh", std::make_unique<Mesh>(smoothBall(false)), 0});
    cases.push_back({"box", std::make_unique<Mesh>(boxMesh({-0.5, -0.6, -0.7}, {0.5, 0.6, 0.7})), 0});
    cases.push_back({"plane", std::make_unique<Plane>(Vec3d{0, 0.1, 0}, Vec3d{0.1, 1, 0}), 0});
    cases.push_back({"disk", std::make_unique<Disk>(Vec3d{0, 0.1, 0}, Vec3d{0.1, 1, 0}, 1.0), 0});
    cases.push_back(
        {"quad", std::make_unique<Quad>(Vec3{-1, 0, -1}, Vec3{-1, 0.2f, 1}, Vec3{1, 0, 1}, Vec3{1, 0.1f, -1}), 0});
    for (const Case& c : cases) {
        CAPTURE(c.name);
        const PatchReport r = study(*c.shape, 1e-4);
        CHECK(r.hits > 40);
        CHECK(r.offLine < 1e-9);
        CHECK(r.offHit < 1e-5); // single precision at grazing angles
        CHECK(r.normal < 5e-6);
        CHECK(r.change < 2e-6 * (1 + square(r.curved)));
        CHECK(r.curved >= c.curved);
        CHECK((c.curved > 0 || r.curved == 0));
    }
}

TEST_CASE("lines that pass a surface by have no patch") {
    const Sphere ball({0, 0, 0}, 1);
    const Torus ring(1, 0.2, Transform{});
    SurfaceHit hit;
    hit.p = {1, 0, 0};
    CHECK_FALSE(ball.patch(hit, {-3, 1.01, 0}, {1, 0, 0}).has_value());
    CHECK(ball.patch(hit, {-3, 0.99, 0}, {1, 0, 0}).has_value());
    hit.p = {0, 0.2f, 1};
    CHECK_FALSE(ring.patch(hit, {-3, 0.21, 1}, {1, 0, 0}).has_value());
}

} // namespace abbe::test
