// Points of emitters by their texture coordinates, and hits by their points: what lights with textures need.
#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

std::optional<SurfaceHit> hitOf(const Shape& shape, Vec3 p, Vec3 ng, std::uint32_t part) {
    const Ray ray = rayOnto(p, ng, 1e-3f * shape.bounds().radius());
    const auto raw = shape.sampling()->locate(p, part, ray);
    if (!raw) return std::nullopt;
    SurfaceHit hit;
    shape.surface(*raw, ray, hit);
    shape.parametrize(*raw, ray, hit);
    return hit;
}

void near(Vec3 a, Vec3 b, float tolerance) {
    CAPTURE(a.x - b.x);
    CAPTURE(a.y - b.y);
    CAPTURE(a.z - b.z);
    CHECK(length(a - b) <= tolerance);
}

Transform someMap(Vec3d scale) {
    return Transform::scale(scale).then(Transform::rotate({1, 2, 3}, 0.7)).then(Transform::translate({2, -1, 4}));
}

} // namespace

TEST_CASE("texture coordinates lead to their point, and its area, and back") {
    Diagnostics diagnostics;
    std::vector<std::unique_ptr<const Shape>> shapes;
    shapes.push_back(std::make_unique<Quad>(Vec3{0, 1, 0}, Vec3{2, 1, 0}, Vec3{2, 1, 3}, Vec3{0, 1, 3}));
    shapes.push_back(std::make_unique<Quad>(Vec3{0, 0, 0}, Vec3{2, 0, 0.3f}, Vec3{1.5f, 2, 0.1f}, Vec3{-0.5f, 1, 0}));
    for (const Vec3d scale : {Vec3d{1, 1, 1}, {2, 2, 2}, {1, 2, 0.5}, {-1, 1, 1}, {-1, 3, 0.5}}) {
        const Transform map = someMap(scale);
        shapes.push_back(placeQuad({}, {2, 1}, map, {}, diagnostics));
        shapes.push_back(placeDisk({0.3, 0, 0}, {1, 1, 0}, 0.7, map, {}, diagnostics));
        shapes.push_back(placeSphere({0, 0.2, 0}, 0.7, map, {}, diagnostics));
    }
    test::Random random(5);
    for (const auto& shape : shapes) {
        const float size = shape->bounds().radius();
        double area = 0;
        constexpr int kPoints = 4000;
        for (int i = 0; i < kPoints; ++i) {
            const Vec2 uv{random.uniform(), random.uniform()};
            const auto point = shape->sampling()->uvPoint(uv);
            REQUIRE(point);
            area += static_cast<double>(point->area) / kPoints;
            if (i > 200) continue;
            const auto hit = hitOf(*shape, point->p, point->ng, 0);
            REQUIRE(hit);
            near(hit->p, point->p, 1e-5f * size);
            near(hit->ng, point->ng, 1e-4f);
            const Vec2 back = hit->uv - uv;
            if (uv.x > 0.01f && uv.y > 0.01f && uv.y < 0.99f) { // not where a chart closes
                CHECK(std::abs(back.x) < 2e-4f);
                CHECK(std::abs(back.y) < 2e-4f);
            }
            const float stretch = length(cross(hit->dpdu, hit->dpdv));
            CHECK(stretch == doctest::Approx(static_cast<double>(point->area)).epsilon(2e-3));
        }
        CHECK(area == doctest::Approx(shape->area()).epsilon(0.05));
    }
    CHECK(diagnostics.errorCount() == 0);
}

TEST_CASE("samples of polygons are found again, in the part that they were asked of") {
    MeshData data;
    data.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1f}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2.2f}};
    data.triangles = {{0, 1, 2}, {0, 2, 3}};
    data.quads = {{4, 5, 6, 7}, {0, 1, 5, 4}};
    data.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {3, 0}, {3, 1}, {2, 1}};
    const Mesh mesh(data);
    test::Random random(6);
    for (std::uint32_t part = 0; part < mesh.emitterParts(); ++part)
        for (int i = 0; i < 100; ++i) {
            const auto s = mesh.sample(Vec3{0.3f, 0.4f, 5}, part, {random.uniform(), random.uniform()});
            if (!s) continue;
            const auto hit = hitOf(mesh, s->p, s->ng, part);
            REQUIRE(hit);
            CHECK(hit->primitive == part);
            near(hit->p, s->p, 2e-6f);
            near(hit->ng, s->ng, 1e-5f);
            // Texture coordinates are those of the corners: here a function of the place.
            if (part < 2 || part == 2) {
                CHECK(hit->uv.x - (part == 2 ? 2 : 0) == doctest::Approx(static_cast<double>(s->p.x)).epsilon(1e-4));
                CHECK(hit->uv.y == doctest::Approx(static_cast<double>(s->p.y)).epsilon(1e-4));
            }
        }
}

} // namespace abbe
