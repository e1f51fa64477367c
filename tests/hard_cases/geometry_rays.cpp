// Rays that leave surfaces: docs/hard_cases.md, cases 1-5 and 8.
#include "geometry/disk.h"
#include "geometry/embree_scene.h"
#include "geometry/mesh.h"
#include "geometry/plane.h"
#include "geometry/quad.h"
#include "geometry/sphere.h"
#include "geometry/transformed.h"
#include "support/statistics.h"
#include "unit/geometry/test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

std::unique_ptr<Intersector> sceneOf(std::initializer_list<const Shape*> shapes) {
    EmbreeSceneBuilder builder;
    for (const Shape* s : shapes) builder.addShape(*s, {});
    return builder.build();
}

Vec3 randomDirection(Random& random) {
    const float z = 1 - 2 * random.uniform(), phi = 2 * kPi * random.uniform(), r = safeSqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

// A direction above the surface; every other one grazes it.
Vec3 leaving(Random& random, Vec3 n, int i) {
    const float cosine = std::max(1e-6f, (i & 1 ? 1e-3f : 1.f) * random.uniform());
    const float sine = std::sqrt(1 - cosine * cosine), phi = 2 * kPi * random.uniform();
    return normalize(Frame::fromNormal(n).toWorld({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

// How often rays that leave the outside of a convex shape meet it again.
int falseHits(const Shape& shape, Vec3d centre, double radius, int rays) {
    const auto scene = sceneOf({&shape});
    Random random(7);
    int met = 0, again = 0;
    for (int i = 0; i < rays; ++i) {
        const Vec3 origin(centre + Vec3d(randomDirection(random)) * (3 * radius));
        const Vec3d target = centre + Vec3d(randomDirection(random)) * (0.9 * radius);
        SurfaceHit hit, second;
        const Vec3 d(normalize(target - Vec3d(origin)));
        if (!scene->intersect({origin, d}, hit) || dot(hit.ng, d) >= 0) continue;
        ++met;
        const Vec3 w = leaving(random, hit.ng, i);
        if (dot(w, hit.ng) <= 0) continue;
        const Ray ray{spawnOrigin(hit, w), w};
        again += scene->occluded(ray);
        again += scene->intersect(ray, second);
    }
    CHECK(met > rays * 9 / 10);
    return again;
}

} // namespace

TEST_CASE("case 1: no ray that leaves a convex mesh meets it again") {
    const Mesh sphere(uvSphere(256, 64, {}, 1));
    CHECK(falseHits(sphere, {}, 1, 1000000) == 0);
}

TEST_CASE("case 2: nor far from the origin") {
    // The radius grows beyond 1e4: there a facet of the small sphere is a few roundings wide, and the rounded mesh is
    // no longer convex.
    for (double offset : {10.0, 1e3, 1e4, 1e5}) {
        const Vec3d centre(offset, 0.7 * offset, -0.3 * offset);
        const double radius = offset > 1e4 ? 100 : 1;
        CHECK(falseHits(Mesh(uvSphere(256, 64, centre, radius)), centre, radius, 200000) == 0);
        CHECK(falseHits(Sphere(centre, radius), centre, radius, 200000) == 0);
        const Transform squash =
            Transform::scale({radius, 0.8 * radius, 1.2 * radius}).then(Transform::translate(centre));
        CHECK(falseHits(Transformed(std::make_unique<Sphere>(Vec3d(), 1.0), squash), centre, radius, 200000) == 0);
    }
}

TEST_CASE("case 2: nor from instances") {
    for (double offset : {0.0, 10.0, 1e3, 1e4}) {
        const Mesh sphere(uvSphere(128, 64, {3, 1, 2}, 1));
        const Vec3d centre(offset, 0.7 * offset, -0.3 * offset);
        const Transform map = Transform::translate({-3, -1, -2})
                                  .then(Transform::rotate({1, 2, 3}, 0.7))
                                  .then(Transform::scale({2, -2, 2}))
                                  .then(Transform::translate(centre));
        EmbreeSceneBuilder builder;
        builder.addInstance(builder.addObject({{&sphere, {}}}), map);
        const auto scene = builder.build();
        Random random(3);
        int met = 0, again = 0;
        for (int i = 0; i < 200000; ++i) {
            const Vec3 origin(centre + Vec3d(randomDirection(random)) * 6.0);
            const Vec3 d(normalize(centre + Vec3d(randomDirection(random)) * 1.8 - Vec3d(origin)));
            SurfaceHit hit;
            if (!scene->intersect({origin, d}, hit) || dot(hit.ng, d) >= 0) continue;
            ++met;
            const Vec3 w = leaving(random, hit.ng, i);
            if (dot(w, hit.ng) > 0) again += scene->occluded({spawnOrigin(hit, w), w});
        }
        CHECK(met > 180000);
        CHECK(again == 0);
    }
}

TEST_CASE("case 1: flat shapes through the origin, where the error bound vanishes") {
    const Quad quad({-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1});
    const Plane plane({0, 0, 0}, {0, 1, 0});
    const Plane tilted({0, 0, 0}, {1, 2, 3});
    const Disk disk({0, 0, 0}, {0, 1, 0}, 1);
    const Sphere touching({0, 1, 0}, 1);
    for (const Shape* shape : std::initializer_list<const Shape*>{&quad, &plane, &tilted, &disk, &touching}) {
        const auto scene = sceneOf({shape});
        Random random(5);
        int again = 0, met = 0;
        for (int i = 0; i < 50000; ++i) {
            // Some aim exactly at the origin.
            const Vec3 target = i % 4 == 0 ? Vec3() : Vec3(random.uniform() - 0.5f, 0, random.uniform() - 0.5f);
            const Vec3 origin = randomDirection(random) * 3 + Vec3(0, i % 2 ? 0.f : 1.f, 0);
            SurfaceHit hit;
            const Vec3 d = normalize(target - origin);
            if (!scene->intersect({origin, d}, hit)) continue;
            ++met;
            Vec3 n = dot(hit.ng, d) < 0 ? hit.ng : -hit.ng;
            if (shape == &touching) n = hit.ng;
            const Vec3 w = leaving(random, n, i);
            if (dot(w, n) > 0) again += scene->occluded({spawnOrigin(hit, w), w});
        }
        CHECK(met > 20000);
        CHECK(again == 0);
    }
}

TEST_CASE("case 3: two sheets 1e-5 apart at a distance of 10") {
    for (Vec3 normal : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-1, 0.1f, 0.2f)}) {
        const Frame f = Frame::fromNormal(normalize(normal));
        const auto sheet = [&](double height) {
            MeshData m;
            constexpr int steps = 8;
            for (int j = 0; j <= steps; ++j)
                for (int i = 0; i <= steps; ++i)
                    m.positions.push_back(Vec3(Vec3d(f.z) * height + Vec3d(f.x) * (10.0 * i / steps - 5) +
                                               Vec3d(f.y) * (10.0 * j / steps - 5)));
            for (std::uint32_t j = 0; j < steps; ++j)
                for (std::uint32_t i = 0; i < steps; ++i) {
                    const std::uint32_t a = j * (steps + 1) + i;
                    m.triangles.push_back({a, a + 1, a + steps + 2});
                    m.triangles.push_back({a, a + steps + 2, a + steps + 1});
                }
            return Mesh(std::move(m));
        };
        const double gap = 1e-5;
        const Mesh near = sheet(10), far = sheet(10 + gap);
        const auto scene = sceneOf({&near, &far});
        Random random(9);
        int leaks = 0, self = 0;
        for (int i = 0; i < 300000; ++i) {
            const Vec3 target = f.z * 10 + f.x * (8 * random.uniform() - 4) + f.y * (8 * random.uniform() - 4);
            SurfaceHit hit, second;
            if (!scene->intersect({{0, 0, 0}, normalize(target)}, hit)) {
                ++leaks;
                continue;
            }
            // On through the first sheet: the second must stop it, and the first must not.
            const float cosine = i & 1 ? std::max(1e-4f, random.uniform()) : 0.01f + 0.1f * random.uniform();
            const float sine = safeSqrt(1 - cosine * cosine), phi = 2 * kPi * random.uniform();
            const Vec3 w = normalize(f.toWorld({sine * std::cos(phi), sine * std::sin(phi), cosine}));
            if (!scene->intersect({spawnOrigin(hit, w), w}, second))
                ++leaks;
            else if (dot(second.p - hit.p, f.z) < 0.2f * static_cast<float>(gap))
                ++self;
        }
        CHECK(leaks == 0);
        CHECK(self == 0);
    }
}

// Thin triangles far away, met edge-on, as in Embree's issues 387, 416 and 423: hits that are not there.
TEST_CASE("case 4: slivers met edge-on") {
    Random random(1);
    int hits = 0, wrong = 0, expected = 0, lost = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3d e(randomDirection(random)), f = normalize(cross(e, Vec3d(randomDirection(random))));
        const Vec3d n = cross(e, f), base = Vec3d(randomDirection(random)) * 300;
        const double width = 1.4 * std::pow(10.0, -3 * random.uniformDouble());
        MeshData m;
        m.positions = {Vec3(base), Vec3(base + e * 11.2), Vec3(base + e * (9.7 * random.uniformDouble()) + f * width)};
        m.triangles = {{0, 1, 2}};
        const Mesh mesh(m);
        const auto scene = sceneOf({&mesh});
        const Vec3d a(m.positions[0]), e1 = Vec3d(m.positions[1]) - a, e2 = Vec3d(m.positions[2]) - a;
        for (int i = 0; i < 100; ++i) {
            const Vec3d target = base + e * (14 * random.uniformDouble() - 1) + f * (3 * random.uniformDouble() - 1);
            const double angle = (i & 1 ? 1 : -1) * std::pow(10.0, -1 - 4 * random.uniformDouble());
            const Vec3d along = normalize(e * (2 * random.uniformDouble() - 1) + f * (2 * random.uniformDouble() - 1));
            const Vec3d d0 = along * std::cos(angle) + n * std::sin(angle);
            const Vec3 o(target - d0 * (600 * random.uniformDouble())), d(normalize(d0));
            // In double: is it inside by a margin, or outside by one?
            const Vec3d p = cross(Vec3d(d), e2), s = Vec3d(o) - a, q = cross(s, e1);
            const double det = dot(e1, p), u = dot(s, p) / det, v = dot(Vec3d(d), q) / det, t = dot(e2, q) / det;
            const double inside = std::min({u, v, 1 - u - v});
            SurfaceHit hit;
            const bool met = scene->intersect({o, d}, hit);
            hits += met;
            const bool certain = inside > 0.02 && t > 1 && std::abs(angle) > 1e-3;
            expected += certain;
            lost += certain && !met;
            if (!met) continue;
            const Vec3d x = Vec3d(hit.p) - Vec3d(o);
            const double off = length(x - Vec3d(d) * dot(x, Vec3d(d)));
            const double tolerance = 16.0 * static_cast<double>(maxComponent(hit.pError)) + 1e-3;
            if (off > tolerance || std::abs(static_cast<double>(hit.distance) - dot(x, Vec3d(d))) > 1e-2) ++wrong;
        }
    }
    CHECK(hits > 4000);
    CHECK(expected > 2000);
    CHECK(wrong == 0);
    CHECK(lost <= expected / 200); // Embree itself misses a few
}

TEST_CASE("case 5: nothing escapes from a closed mesh") {
    const Mesh sphere(icosphere(6, {0.3, 0.2, 0.1}, 1));
    const auto scene = sceneOf({&sphere});
    Random random(2);
    int escaped = 0;
    for (int i = 0; i < 1000000; ++i) {
        SurfaceHit hit;
        const Vec3 origin = Vec3(0.3f, 0.2f, 0.1f) + randomDirection(random) * (0.9f * random.uniform());
        escaped += !scene->intersect({origin, randomDirection(random)}, hit);
    }
    CHECK(escaped == 0);
}

// The whole chain of a shadow ray to a lamp: it must not be stopped by the lamp or by the surface it leaves.
TEST_CASE("case 1: shadow rays end before the lamp") {
    for (float scale : {1e-5f, 1.f, 1e5f}) {
        const auto at = [scale](float x, float y, float z) { return Vec3(x, y, z) * scale; };
        const Quad floor(at(-9, 0.3f, -9), at(-9, 0.3f, 9), at(9, 0.3f, 9), at(9, 0.3f, -9));
        const Quad tilted(at(-1, 5, -1), at(1, 5.3f, -1), at(1.2f, 5.5f, 1), at(-0.8f, 5.2f, 1));
        const Sphere ball(Vec3d(at(3, 4, 1)), 0.5 * static_cast<double>(scale));
        const auto scene = sceneOf({&floor, &tilted, &ball});
        Random random(8);
        int blocked = 0, tried = 0;
        for (int i = 0; i < 100000; ++i) {
            SurfaceHit hit;
            const Vec3 above = at(16 * random.uniform() - 8, 1, 16 * random.uniform() - 8);
            REQUIRE(scene->intersect({above, {0, -1, 0}}, hit));
            const Shape& lamp = i & 1 ? static_cast<const Shape&>(tilted) : ball;
            const auto s = lamp.sample(hit.p, 0, {random.uniform(), random.uniform()});
            if (!s) continue;
            const Vec3 to = s->p - hit.p;
            if (dot(to, s->ng) * (i & 1 ? -1.f : 1.f) > -1e-3f * length(to)) continue; // edge-on
            const float rounding = 0x1p-21f * length(to);
            const Vec3 end = spawnOrigin(s->p, s->pError + Vec3(rounding, rounding, rounding), s->ng, -to);
            const Vec3 start = spawnOrigin(hit, to);
            const float distance = length(end - start);
            const Ray shadow{start, (end - start) * (1 / distance), distance};
            SurfaceHit other; // the two lamps may shade each other
            if (scene->occluded(shadow) && scene->intersect(shadow, other) && length(other.p - s->p) < 1e-3f * scale)
                ++blocked;
            ++tried;
        }
        CHECK(tried > 40000);
        CHECK(blocked == 0);
    }
}

TEST_CASE("case 8: the same scene at 1e-5 and 1e5 of its size") {
    std::vector<double> sums;
    for (double scale : {1e-5, 1.0, 1e5}) {
        const MeshData room =
            moved(cube({-2.78f, -2.74f, -2.8f}, {2.78f, 2.74f, 2.8f}), Transform::scale({scale, scale, scale}));
        const MeshData box = moved(cube({-1, -2.74f, -1}, {0.5f, -1, 0.5f}),
                                   Transform::rotate({0, 1, 0}, 0.3).then(Transform::scale({scale, scale, scale})));
        const Mesh roomMesh(room), boxMesh(box);
        const Sphere ball(Vec3d(1, -1, 1) * scale, 0.7 * scale);
        const auto scene = sceneOf({&roomMesh, &boxMesh, &ball});
        Random random(4);
        int escaped = 0;
        double sum = 0;
        // Light paths of ten segments bounce about: all stay inside, and all take the same way.
        for (int i = 0; i < 20000; ++i) {
            Vec3 origin = Vec3(Vec3d(0, 2, 0) * scale), d = randomDirection(random);
            for (int bounce = 0; bounce < 10; ++bounce) {
                SurfaceHit hit;
                if (!scene->intersect({origin, d}, hit)) {
                    ++escaped;
                    break;
                }
                if (bounce < 3) sum += static_cast<double>(hit.distance) / scale;
                const Vec3 n = dot(hit.ng, d) < 0 ? hit.ng : -hit.ng;
                d = leaving(random, n, 0);
                origin = spawnOrigin(hit, d);
            }
        }
        CHECK(escaped == 0);
        sums.push_back(sum);
    }
    CHECK(sums[0] == doctest::Approx(sums[1]).epsilon(1e-4));
    CHECK(sums[2] == doctest::Approx(sums[1]).epsilon(1e-4));
}
