// Curves against their definitions, solved in double without Embree.
#include "geometry/curves.h"
#include "geometry/embree_scene_builder.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <numeric>

using namespace abbe;
using namespace abbe::test;

namespace {

constexpr CurveBasis kBases[] = {CurveBasis::linear, CurveBasis::bspline, CurveBasis::catmullRom, CurveBasis::bezier};

Vec3 inCube(Random& random) { return Vec3(random.uniform(), random.uniform(), random.uniform()) * 2 - Vec3(1, 1, 1); }
Vec3 direction(Random& random) {
    for (;;)
        if (const Vec3 v = inCube(random); lengthSquared(v) < 1 && lengthSquared(v) > 0.01f) return normalize(v);
}

// A strand that wanders from `start` without sharp turns. Requires step > 0.
std::vector<SizedPoint> wander(Random& random, Vec3 start, int count, float step, float radius, float taper = 0) {
    std::vector<SizedPoint> points;
    Vec3 p = start, d = direction(random);
    for (int i = 0; i < count; ++i) {
        points.push_back({p, radius * (1 - taper * static_cast<float>(i) / static_cast<float>(count))});
        d = normalize(d + direction(random) * 0.4f);
        p += d * step;
    }
    return points;
}

std::uint32_t pointsFor(CurveBasis basis, std::uint32_t segments) {
    return leastPoints(basis) + (segments - 1) * pointStep(basis);
}

struct BruteHit {
    double t = std::numeric_limits<double>::infinity();
    double u = 0;
    int segment = -1;
};

// A tube is swept by circles at right angles to the curve. For each u the ray meets the circle's plane once; the hits
// are where its distance from the centre there is the radius.
BruteHit bruteTube(const std::vector<CurveSegment>& segments, Vec3d o, Vec3d d) {
    BruteHit best;
    for (std::size_t k = 0; k < segments.size(); ++k) {
        const CurveSegment& s = segments[k];
        double t = 0;
        const auto excess = [&](double u) {
            const Vec3d c = s.position(u), tangent = *s.tangent(u);
            t = dot(c - o, tangent) / dot(d, tangent);
            return lengthSquared(o + d * t - c) - square(s.radius(u));
        };
        constexpr int cells = 400;
        double before = excess(0);
        for (int i = 1; i <= cells; ++i) {
            double a = (i - 1.0) / cells, b = i / double(cells);
            const double after = excess(b);
            if ((before < 0) != (after < 0)) {
                for (int j = 0; j < 50; ++j) {
                    const double m = 0.5 * (a + b);
                    ((excess(m) < 0) == (before < 0) ? a : b) = m;
                }
                const double e = excess(a);
                if (std::abs(e) < 1e-9 && t > 0 && t < best.t) best = {t, a, static_cast<int>(k)};
            }
            before = after;
        }
    }
    return best;
}

// Spheres swept along segments, by the distance to the surface: the ray steps as far as nothing can be.
BruteHit bruteCones(const std::vector<SizedPoint>& p, Vec3d o, Vec3d d) {
    const auto distance = [&](Vec3d q, std::size_t k) {
        double best = std::numeric_limits<double>::infinity();
        const Vec3d a(p[k].position), b(p[k + 1].position);
        const auto at = [&](double s) {
            const double r = lerp<double>(static_cast<double>(p[k].radius), static_cast<double>(p[k + 1].radius), s);
            return length(q - (a + (b - a) * s)) - r;
        };
        double lo = 0, hi = 1; // convex in s
        for (int i = 0; i < 60; ++i) {
            const double x = lo + (hi - lo) / 3, y = hi - (hi - lo) / 3;
            if (at(x) < at(y))
                hi = y;
            else
                lo = x;
        }
        best = std::min(best, at(0.5 * (lo + hi)));
        return best;
    };
    BruteHit best;
    for (std::size_t k = 0; k + 1 < p.size(); ++k) {
        double t = 0;
        for (int i = 0; i < 400 && t < 10; ++i) {
            const double step = distance(o + d * t, k);
            if (step < 1e-10) {
                if (t < best.t) best = {t, 0, static_cast<int>(k)};
                break;
            }
            t += step;
        }
    }
    return best;
}

std::unique_ptr<Intersector> strandIntersector(const Shape& shape) {
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    return builder.build();
}

bool soundFrame(const SurfaceHit& h) {
    const auto unit = [](Vec3 v) { return std::abs(length(v) - 1) < 1e-4f; };
    return isFinite(h.p) && isFinite(h.pError) && minComponent(h.pError) >= 0 && unit(h.ng) && unit(h.shading.x) &&
           unit(h.shading.y) && unit(h.shading.z) && std::abs(dot(h.shading.x, h.shading.y)) < 1e-4f &&
           dot(h.shading.z, h.ng) > 0.99f && h.uv.x >= 0 && h.uv.x <= 1 && h.uv.y >= 0 && h.uv.y <= 1;
}

} // namespace

TEST_CASE("curves: segments pass through what their basis promises" * doctest::test_suite("input")) {
    const SizedPoint p[] = {{{0, 0, 0}, 1}, {{1, 0, 0}, 2}, {{1, 1, 0}, 3}, {{0, 1, 1}, 5}};
    const auto same = [](Vec3d a, Vec3d b) { return length(a - b) < 1e-12; };
    const CurveSegment linear(CurveBasis::linear, p), bspline(CurveBasis::bspline, p);
    const CurveSegment catmull(CurveBasis::catmullRom, p), bezier(CurveBasis::bezier, p);
    CHECK(same(linear.position(0.25), {0.25, 0, 0}));
    CHECK(linear.radius(0.25) == doctest::Approx(1.25));
    CHECK(same(bspline.position(0), {5. / 6, 1. / 6, 0}));
    CHECK(same(bspline.derivative(0), {0.5, 0.5, 0}));
    CHECK(same(catmull.position(0), {1, 0, 0}));
    CHECK(same(catmull.position(1), {1, 1, 0}));
    CHECK(same(catmull.derivative(0), {0.5, 0.5, 0}));
    CHECK(catmull.radius(1) == doctest::Approx(3));
    CHECK(same(bezier.position(0), {0, 0, 0}));
    CHECK(same(bezier.position(1), {0, 1, 1}));
    CHECK(same(bezier.position(0.5), Vec3d(6, 4, 1) * 0.125));
    for (const CurveSegment& s : {linear, bspline, catmull, bezier})
        for (double u : {0.1, 0.5, 0.8}) {
            const Vec3d slope = (s.position(u + 1e-5) - s.position(u - 1e-5)) * (0.5e5);
            CHECK(length(slope - s.derivative(u)) < 1e-8);
            const Vec3d bend = (s.derivative(u + 1e-5) - s.derivative(u - 1e-5)) * (0.5e5);
            CHECK(length(bend - s.secondDerivative(u)) < 1e-8);
            CHECK((s.radius(u + 1e-5) - s.radius(u - 1e-5)) * 0.5e5 == doctest::Approx(s.radiusDerivative(u)));
        }
}

TEST_CASE("curves: tubes are met where circles at right angles to the curve sweep") {
    for (CurveBasis basis : {CurveBasis::bspline, CurveBasis::catmullRom, CurveBasis::bezier}) {
        CAPTURE(int(basis));
        Random random(5);
        int met = 0, differing = 0, rays = 0;
        for (int strand = 0; strand < 30; ++strand) {
            const std::uint32_t count = pointsFor(basis, 3);
            const float step = basis == CurveBasis::bezier ? 0.1f : 0.3f;
            CurveData data{basis, CurveForm::round, wander(random, inCube(random), int(count), step, 0.05f, 0.6f), {}};
            data.strandSizes = {count};
            std::vector<CurveSegment> segments;
            for (std::uint32_t i = 0; i + leastPoints(basis) <= count; i += pointStep(basis))
                segments.emplace_back(basis, &data.points[i]);
            const std::vector<SizedPoint> points = data.points;
            const Curves curves(std::move(data));
            const auto scene = strandIntersector(curves);
            for (int i = 0; i < 200; ++i) {
                const Vec3 target(segments[std::size_t(i) % segments.size()].position(random.uniform()));
                const Vec3 o = target + direction(random) * 3;
                const Vec3 d = normalize(target + direction(random) * 0.05f - o);
                const BruteHit expected = bruteTube(segments, Vec3d(o), Vec3d(d));
                SurfaceHit hit;
                const bool isMet = scene->intersect({o, d}, hit);
                ++rays;
                if (isMet != (expected.segment >= 0) ||
                    (isMet && std::abs(static_cast<double>(hit.distance) - expected.t) > 1e-4)) {
                    ++differing; // silhouettes, and the rims of the open ends
                    continue;
                }
                if (!isMet) continue;
                ++met;
                CHECK(soundFrame(hit));
                const CurveSegment& s = segments[std::size_t(expected.segment)];
                const Vec3d c = s.position(expected.u), tangent = *s.tangent(expected.u);
                const Vec3d p = Vec3d(o) + Vec3d(d) * expected.t;
                const double across = std::abs(dot(normalize(p - c), normalize(cross(tangent, Vec3d(d)))));
                if (across > 0.98) continue; // edge-on a little along the ray is a lot along the surface
                {
                    CHECK(length(Vec3d(hit.p) - p) < 2e-5);
                    CHECK(std::abs(dot(Vec3d(hit.shading.x), tangent)) > 0.9);
                    const double along = (expected.segment + expected.u) / double(segments.size());
                    CHECK(static_cast<double>(hit.uv.x) == doctest::Approx(along).epsilon(0.002));
                    CHECK(std::abs(static_cast<double>(hit.uv.y) * 2 - 1) == doctest::Approx(across).epsilon(0.01));
                }
                // The normal by differences on the surface around the hit.
                const auto rim = [&](double u, double angle) {
                    const Vec3d t = *s.tangent(u);
                    const Vec3d reference = normalize(p - c), x = normalize(reference - t * dot(reference, t));
                    return s.position(u) + (x * std::cos(angle) + cross(t, x) * std::sin(angle)) * s.radius(u);
                };
                const double h = 1e-5, u = std::clamp(expected.u, h, 1 - h);
                Vec3d n = normalize(cross(rim(u + h, 0) - rim(u - h, 0), rim(u, h) - rim(u, -h)));
                if (dot(n, p - c) < 0) n = -n;
                CHECK(length(n - Vec3d(hit.ng)) < 2e-3);
            }
        }
        CAPTURE(differing);
        CHECK(met > rays / 2);
        CHECK(differing < rays / 100);
    }
}

TEST_CASE("curves: linear tubes are spheres swept along their segments") {
    Random random(6);
    int met = 0, differing = 0;
    for (int strand = 0; strand < 20; ++strand) {
        CurveData data{CurveBasis::linear, CurveForm::round, wander(random, inCube(random), 4, 0.3f, 0.05f, 0.6f), {4}};
        if (strand % 4 == 3) data.points[2].radius = 0.2f; // a bulge
        const std::vector<SizedPoint> points = data.points;
        const Curves curves(std::move(data));
        const auto scene = strandIntersector(curves);
        for (int i = 0; i < 200; ++i) {
            const std::size_t k = std::size_t(i) % 3;
            const Vec3 target =
                points[k].position + (points[k + 1].position - points[k].position) * float(random.uniform());
            const Vec3 o = target + direction(random) * 3;
            const Vec3 d = normalize(target + direction(random) * 0.06f - o);
            const BruteHit expected = bruteCones(points, Vec3d(o), Vec3d(d));
            SurfaceHit hit;
            const bool isMet = scene->intersect({o, d}, hit);
            if (isMet != (expected.segment >= 0) ||
                (isMet && std::abs(static_cast<double>(hit.distance) - expected.t) > 1e-4)) {
                ++differing;
                continue;
            }
            if (!isMet) continue;
            ++met;
            CHECK(soundFrame(hit));
            CHECK(dot(hit.ng, d) < 1e-3f);
            const Vec3d p = Vec3d(o) + Vec3d(d) * expected.t;
            CHECK(length(Vec3d(hit.p) - p) < 2e-5);
        }
    }
    CAPTURE(differing);
    CHECK(met > 2000);
    CHECK(differing < 20);
}

TEST_CASE("curves: ribbons turn to the ray and are as wide as they say") {
    for (CurveBasis basis : kBases) {
        CAPTURE(int(basis));
        // Along x, straight: Catmull-Rom and B-splines run between the second and third point.
        CurveData data{basis, CurveForm::flat, {}, {4}};
        for (int i = 0; i < 4; ++i) data.points.push_back({{static_cast<float>(i), 0, 0}, 0.1f});
        const Curves curves(std::move(data));
        const auto scene = strandIntersector(curves);
        Random random(7);
        for (int i = 0; i < 1000; ++i) {
            const float x = 1.3f + 0.4f * float(random.uniform()), angle = 6.28f * float(random.uniform());
            const float across = 2.4f * float(random.uniform()) - 1.2f;
            if (std::abs(std::abs(across) - 1) < 0.01f) continue;
            const Vec3 away(0, std::cos(angle), std::sin(angle)), side(0, -std::sin(angle), std::cos(angle));
            const Vec3 d = normalize(-away + Vec3(1, 0, 0) * (float(random.uniform()) - 0.5f));
            const Vec3 o = Vec3(x, 0, 0) + side * (across * 0.1f) - d * 4;
            SurfaceHit hit;
            const bool met = scene->intersect({o, d}, hit);
            CHECK(met == (std::abs(across) < 1));
            CHECK(scene->occluded({o, d}) == met);
            if (!met) continue;
            CHECK(soundFrame(hit));
            CHECK(length(hit.ng - away) < 1e-3f);
            CHECK(std::abs(dot(hit.p, away)) < 1e-3f);
            CHECK(std::abs(hit.p.x - x) < 1e-3f);
            CHECK(std::abs(std::abs(hit.uv.y * 2 - 1) - std::abs(across)) < 1e-3f);
            CHECK(hit.shading.x.x > 0.999f);
            const float u = basis == CurveBasis::linear || basis == CurveBasis::bezier ? x / 3 : x - 1;
            CHECK(hit.uv.x == doctest::Approx(u).epsilon(1e-3));
        }
    }
}

// Light that leaves a convex tube never comes back to it: any hit is a false shadow.
TEST_CASE("curves: no ray that leaves a straight tube meets it again") {
    for (CurveBasis basis : kBases)
        for (float offset : {0.f, 10.f, 1000.f})
            for (float scale : {1.f, 0.001f, 100.f})
                for (float width : {0.1f, 0.01f}) {
                    CAPTURE(int(basis));
                    CAPTURE(offset);
                    CAPTURE(scale);
                    CAPTURE(width);
                    Random random(8);
                    const Vec3 axis = direction(random), start = Vec3(offset, -offset, 0.7f * offset) * scale;
                    CurveData data{basis, CurveForm::round, {}, {4}};
                    for (int i = 0; i < 4; ++i)
                        data.points.push_back({start + axis * (scale * static_cast<float>(i)), width * scale});
                    const Curves curves(std::move(data));
                    const auto scene = strandIntersector(curves);
                    int leaving = 0, again = 0;
                    for (int i = 0; i < 20000; ++i) {
                        const Vec3 target = start + axis * (scale * (1.1f + 0.8f * float(random.uniform())));
                        const Vec3 o = target + direction(random) * (3 * scale);
                        SurfaceHit hit;
                        if (!scene->intersect({o, normalize(target - o)}, hit)) continue;
                        Vec3 w = direction(random);
                        if (i % 2)
                            w = normalize(hit.ng * (0.01f * float(random.uniform())) +
                                          hit.shading.toWorld({w.x, w.y, 0}));
                        if (dot(w, hit.ng) <= 0) w = normalize(w - hit.ng * (2 * dot(w, hit.ng)));
                        if (dot(w, hit.ng) <= 0) continue;
                        ++leaving;
                        again += scene->occluded({spawnOrigin(hit, w), w});
                    }
                    CHECK(leaving > 15000);
                    CHECK(again == 0);
                }
}

TEST_CASE("curves: tubes seen from inside are met where the ray leaves") {
    for (CurveBasis basis : kBases) {
        CAPTURE(int(basis));
        CurveData data{basis, CurveForm::round, {}, {4}};
        for (int i = 0; i < 4; ++i) data.points.push_back({{static_cast<float>(i), 0, 0}, 0.1f});
        const Curves curves(std::move(data));
        const auto scene = strandIntersector(curves);
        SurfaceHit hit;
        REQUIRE(scene->intersect({{1.5f, 0, 0}, {0, 1, 0}}, hit));
        CHECK(hit.distance == doctest::Approx(0.1).epsilon(1e-4));
        CHECK(hit.ng.y > 0.999f);
    }
}

// docs/hard_cases.md, case 22.
TEST_CASE("curves: a hairball with one bad strand in a hundred gives nothing but finite hits") {
    for (CurveBasis basis : kBases)
        for (CurveForm form : {CurveForm::round, CurveForm::flat}) {
            CAPTURE(int(basis));
            CAPTURE(int(form));
            Random random(9);
            CurveData data{basis, form, {}, {}};
            const std::uint32_t count = pointsFor(basis, 4);
            for (int i = 0; i < 2000; ++i) {
                auto strand = wander(random, inCube(random) * 0.2f, int(count), 0.2f, 0.02f, 0.5f);
                if (i % 100 == 1) // all in one place
                    for (SizedPoint& p : strand) p.position = strand[0].position;
                if (i % 100 == 2) strand[2].position = strand[1].position;
                if (i % 100 == 3) strand[3].position = strand[1].position; // there and back: a cusp
                if (i % 100 == 4)
                    for (SizedPoint& p : strand) p.radius = 0;
                if (i % 100 == 5) strand[2].radius = 0;
                if (i % 100 == 6) strand[1].position = strand[2].position = strand[3].position = strand[0].position;
                if (i % 100 == 7) strand[2].radius = 3; // thicker than long
                data.points.insert(data.points.end(), strand.begin(), strand.end());
                data.strandSizes.push_back(count);
            }
            const Curves curves(std::move(data));
            CHECK(curves.omittedSegments() >= 20 * 4 * 2);
            CHECK(curves.segmentCount() + curves.omittedSegments() == 2000 * 4);
            CHECK(std::isfinite(curves.area()));
            const auto scene = strandIntersector(curves);
            int met = 0, unsound = 0;
            for (int i = 0; i < 20000; ++i) {
                SurfaceHit hit;
                const Vec3 o = direction(random) * 9, target = inCube(random) * 0.5f;
                if (!scene->intersect({o, normalize(target - o)}, hit)) continue;
                ++met;
                unsound += !soundFrame(hit);
            }
            CHECK(met > 5000);
            CHECK(unsound == 0);
        }
}

TEST_CASE("curves: instances mirror, turn and stretch tubes as they would their points") {
    Random random(10);
    for (CurveBasis basis : kBases)
        for (CurveForm form : {CurveForm::round, CurveForm::flat}) {
            const std::uint32_t count = pointsFor(basis, 4);
            CurveData data{basis, form, wander(random, {}, int(count), 0.3f, 0.05f, 0.4f), {count}};
            const Curves object(data);
            for (const Transform& map : {Transform::scale({-2, 2, 2}).then(Transform::translate({1, 2, 3})),
                                         Transform::rotate({1, 2, 3}, 1.1).then(Transform::scale({0.5, 0.5, 0.5}))}) {
                CurveData moved = data;
                for (SizedPoint& p : moved.points)
                    p = {Vec3(map.point(Vec3d(p.position))), p.radius * static_cast<float>(*map.uniformScale())};
                const Curves baked(moved);
                EmbreeSceneBuilder builder;
                builder.addInstance(builder.addObject({{&object, {}}}), map);
                const auto direct = strandIntersector(baked), instanced = builder.build();
                CAPTURE(int(basis));
                CAPTURE(int(form));
                int met = 0, differing = 0;
                for (int i = 0; i < 3000; ++i) {
                    const Vec3 target = moved.points[std::size_t(i) % count].position + inCube(random) * 0.05f;
                    const Vec3 o = target + direction(random) * 3;
                    const Ray ray{o, normalize(target - o)};
                    SurfaceHit a, b;
                    const bool ma = direct->intersect(ray, a), mb = instanced->intersect(ray, b);
                    if (ma != mb || (ma && length(a.p - b.p) > 1e-4f)) {
                        ++differing; // silhouettes
                        continue;
                    }
                    if (!ma) continue;
                    ++met;
                    differing += length(a.ng - b.ng) > 0.02f;
                    CHECK(soundFrame(b));
                }
                CHECK(met > 600);
                CHECK(differing < 40); // ribbons seen along their length
            }
        }
    // Twice as high as wide: an elliptical tube.
    CurveData data{CurveBasis::linear, CurveForm::round, {{{-1, 0, 0}, 0.1f}, {{1, 0, 0}, 0.1f}}, {2}};
    const Curves object(data);
    EmbreeSceneBuilder builder;
    builder.addInstance(builder.addObject({{&object, {}}}), Transform::scale({1, 2, 1}));
    const auto scene = builder.build();
    SurfaceHit hit;
    REQUIRE(scene->intersect({{0.2f, 3, 0}, {0, -1, 0}}, hit));
    CHECK(hit.p.y == doctest::Approx(0.2));
    REQUIRE(scene->intersect({{0.2f, 0, 3}, {0, 0, -1}}, hit));
    CHECK(hit.p.z == doctest::Approx(0.1));
    REQUIRE(scene->intersect({{0.2f, 0.1f, 3}, {0, 0, -1}}, hit)); // y²/0.04 + z²/0.01 = 1
    CHECK(hit.p.z == doctest::Approx(0.1 * std::sqrt(0.75)).epsilon(1e-4));
    CHECK(length(hit.ng - normalize(Vec3(0, 0.1f / 0.04f, hit.p.z / 0.01f))) < 1e-3f);
}

TEST_CASE("curves: hits name their strand, and u runs along all of it") {
    CurveData data{CurveBasis::linear, CurveForm::round, {}, {2, 5, 3}};
    float y = 0;
    for (std::uint32_t size : {2u, 5u, 3u}) {
        for (std::uint32_t i = 0; i < size; ++i) data.points.push_back({{static_cast<float>(i), y, 0}, 0.1f});
        y += 1;
    }
    data.points[4].position = data.points[3].position; // an empty segment counts: the points are where they are
    const Curves curves(std::move(data));
    CHECK(curves.omittedSegments() == 1);
    const auto scene = strandIntersector(curves);
    SurfaceHit hit;
    REQUIRE(scene->intersect({{0.5f, 0, 3}, {0, 0, -1}}, hit));
    CHECK(hit.primitive == 0);
    CHECK(hit.uv.x == doctest::Approx(0.5));
    REQUIRE(scene->intersect({{3.5f, 1, 3}, {0, 0, -1}}, hit));
    CHECK(hit.primitive == 1);
    CHECK(hit.uv.x == doctest::Approx(3.5 / 4));
    REQUIRE(scene->intersect({{1.25f, 2, 3}, {0, 0, -1}}, hit));
    CHECK(hit.primitive == 2);
    CHECK(hit.uv.x == doctest::Approx(1.25 / 2));
    CHECK(curves.area() == doctest::Approx(2 * kPiD * 0.1 * (1 + 4 + 2)).epsilon(1e-6));
}

TEST_CASE("curves: bounds hold every hit") {
    Random random(11);
    for (CurveBasis basis : kBases) {
        const std::uint32_t count = pointsFor(basis, 6);
        const Curves curves({basis, CurveForm::round, wander(random, {}, int(count), 0.3f, 0.05f), {count}});
        const auto scene = strandIntersector(curves);
        const Bounds3 b = curves.bounds();
        for (int i = 0; i < 5000; ++i) {
            const Vec3 o = b.centre() + direction(random) * (2 * b.radius());
            SurfaceHit hit;
            if (!scene->intersect({o, normalize(b.centre() + inCube(random) * (0.7f * b.radius()) - o)}, hit)) continue;
            CHECK(minComponent(hit.p - b.lower) >= 0);
            CHECK(minComponent(b.upper - hit.p) >= 0);
        }
    }
}
