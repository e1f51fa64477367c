// Points against spheres and disks in double.
#include "geometry/embree_scene_builder.h"
#include "geometry/points.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

constexpr PointForm kForms[] = {PointForm::sphere, PointForm::disk, PointForm::orientedDisk};

Vec3 inPointsCube(Random& random) {
    return Vec3(random.uniform(), random.uniform(), random.uniform()) * 2 - Vec3(1, 1, 1);
}
Vec3 pointsDirection(Random& random) {
    for (;;)
        if (const Vec3 v = inPointsCube(random); lengthSquared(v) < 1 && lengthSquared(v) > 0.01f) return normalize(v);
}

PointData cloud(PointForm form, int count, float radius, Random& random) {
    PointData data{form, {}, {}};
    for (int i = 0; i < count; ++i) {
        data.points.push_back({inPointsCube(random), radius * (0.5f + float(random.uniform()))});
        if (form == PointForm::orientedDisk) data.normals.push_back(pointsDirection(random));
    }
    return data;
}

// Where a ray meets a point, by the formulas of school.
double meet(const PointData& data, std::size_t i, Vec3d o, Vec3d d) {
    const Vec3d c(data.points[i].position);
    const auto r = static_cast<double>(data.points[i].radius);
    const double middle = dot(c - o, d), infinite = std::numeric_limits<double>::infinity();
    double t = middle;
    if (data.form == PointForm::sphere) {
        const double inside = r * r - lengthSquared(o + d * middle - c);
        return inside >= 0 ? middle - std::sqrt(inside) : infinite;
    }
    if (data.form == PointForm::orientedDisk) t = dot(c - o, Vec3d(data.normals[i])) / dot(d, Vec3d(data.normals[i]));
    return lengthSquared(o + d * t - c) <= r * r ? t : infinite;
}

std::unique_ptr<Intersector> pointsIntersector(const Shape& shape) {
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    return builder.build();
}

} // namespace

TEST_CASE("points: met where their spheres and disks are" * doctest::test_suite("input")) {
    for (PointForm form : kForms) {
        CAPTURE(int(form));
        Random random(3);
        const PointData data = cloud(form, 200, 0.1f, random);
        const Points points(data);
        CHECK(points.omitted() == 0);
        const auto scene = pointsIntersector(points);
        int met = 0, differing = 0;
        constexpr int rays = 5000;
        for (int i = 0; i < rays; ++i) {
            const Vec3 o = pointsDirection(random) * 4, d = normalize(inPointsCube(random) - o);
            double nearest = std::numeric_limits<double>::infinity();
            std::size_t which = 0;
            for (std::size_t k = 0; k < data.points.size(); ++k)
                if (const double t = meet(data, k, Vec3d(o), Vec3d(d)); t < nearest) {
                    nearest = t;
                    which = k;
                }
            SurfaceHit hit;
            const bool isMet = scene->intersect({o, d}, hit);
            CHECK(scene->occluded({o, d}) == isMet);
            if (isMet != std::isfinite(nearest) || (isMet && hit.primitive != which)) {
                ++differing; // rims
                continue;
            }
            if (!isMet) continue;
            ++met;
            CHECK(static_cast<double>(hit.distance) == doctest::Approx(nearest).epsilon(1e-5));
            const Vec3d p = Vec3d(o) + Vec3d(d) * nearest, c(data.points[which].position);
            CHECK(length(Vec3d(hit.p) - p) < 2e-5);
            const Vec3d n = form == PointForm::sphere ? normalize(p - c)
                            : form == PointForm::disk ? -Vec3d(d)
                                                      : Vec3d(data.normals[which]);
            CHECK(length(Vec3d(hit.ng) - n) < 1e-3);
            CHECK(length(hit.shading.z - hit.ng) == 0);
            CHECK(std::abs(dot(hit.shading.x, hit.ng)) < 1e-5f);
            CHECK(hit.uv.x >= 0);
            CHECK(hit.uv.x <= 1);
            CHECK(hit.uv.y >= 0);
            CHECK(hit.uv.y <= 1);
        }
        CHECK(met > rays / 10);
        CHECK(differing < rays / 200);
    }
}

// A convex shape alone: any hit after leaving it is a false shadow.
TEST_CASE("points: no ray that leaves a point meets it again") {
    for (PointForm form : kForms)
        for (float offset : {0.f, 10.f, 1000.f})
            for (float scale : {1.f, 0.001f, 100.f}) {
                CAPTURE(int(form));
                CAPTURE(offset);
                CAPTURE(scale);
                Random random(4);
                PointData data{form, {{Vec3(offset, -offset, 0.7f * offset) * scale, 0.3f * scale}}, {}};
                const Vec3 c = data.points[0].position;
                if (form == PointForm::orientedDisk) data.normals.push_back(pointsDirection(random));
                const Points points(std::move(data));
                const auto scene = pointsIntersector(points);
                int leaving = 0, again = 0;
                for (int i = 0; i < 20000; ++i) {
                    const Vec3 o = c + pointsDirection(random) * (3 * scale);
                    SurfaceHit hit;
                    if (!scene->intersect({o, normalize(c + inPointsCube(random) * (0.2f * scale) - o)}, hit)) continue;
                    Vec3 w = pointsDirection(random);
                    if (i % 2)
                        w = normalize(hit.ng * (0.01f * float(random.uniform())) + hit.shading.toWorld({w.x, w.y, 0}));
                    const bool outwards = form == PointForm::sphere || i % 4 < 2;
                    if ((dot(w, hit.ng) > 0) != outwards) w = w - hit.ng * (2 * dot(w, hit.ng));
                    ++leaving;
                    again += scene->occluded({spawnOrigin(hit, w), w});
                }
                CHECK(leaving > 5000);
                CHECK(again == 0);
            }
}

TEST_CASE("points: those without width are left out and counted" * doctest::test_suite("input")) {
    Random random(5);
    for (PointForm form : kForms) {
        PointData data = cloud(form, 100, 0.1f, random);
        for (std::size_t i = 0; i < 100; i += 10) data.points[i].radius = 0;
        data.points[99] = {{9, 9, 9}, 0.5f};
        if (!data.normals.empty()) data.normals[99] = {0, 0, 1};
        const Points points(std::move(data));
        CHECK(points.omitted() == 10);
        CHECK(points.count() == 90);
        const auto scene = pointsIntersector(points);
        SurfaceHit hit;
        REQUIRE(scene->intersect({{9.1f, 9, 12}, {0, 0, -1}}, hit));
        CHECK(hit.primitive == 89);
        CHECK(minComponent(hit.p - points.bounds().lower) >= 0);
        CHECK(minComponent(points.bounds().upper - hit.p) >= 0);
    }
    const Points none({PointForm::sphere, {{{0, 0, 0}, 0}}, {}});
    SurfaceHit hit;
    CHECK_FALSE(pointsIntersector(none)->intersect({{0, 0, 3}, {0, 0, -1}}, hit));
}

TEST_CASE("points: instances stretch spheres to ellipsoids") {
    const Points points({PointForm::sphere, {{{1, 0, 0}, 0.1f}}, {}});
    EmbreeSceneBuilder builder;
    builder.addInstance(builder.addObject({{&points, {}}}), Transform::scale({-1, 2, 1}));
    const auto scene = builder.build();
    SurfaceHit hit;
    REQUIRE(scene->intersect({{-1, 3, 0}, {0, -1, 0}}, hit));
    CHECK(hit.p.y == doctest::Approx(0.2));
    CHECK(hit.ng.y > 0.999f);
    REQUIRE(scene->intersect({{-1, 0.1f, 3}, {0, 0, -1}}, hit)); // y²/0.04 + z²/0.01 = 1
    CHECK(hit.p.z == doctest::Approx(0.1 * std::sqrt(0.75)).epsilon(1e-4));
    CHECK(length(hit.ng - normalize(Vec3(0, 0.1f / 0.04f, hit.p.z / 0.01f))) < 1e-3f);
}
