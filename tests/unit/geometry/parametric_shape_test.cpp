// Cylinders, cones and tori against brute force in double, and what every shape promises.
#include "geometry/flat_shapes.h"
#include "geometry/frustum.h"
#include "geometry/mesh.h"
#include "geometry/torus.h"
#include "shape_test_support.h"

#include <doctest/doctest.h>
#include <functional>
#include <string>

using namespace abbe;
using namespace abbe::test;

namespace {

// A solid as a function that is negative inside, with the shape that claims to be its surface.
struct Solid {
    std::string name;
    std::function<std::unique_ptr<const Shape>(const Transform&)> make;
    std::function<double(Vec3d)> value; // own space; Lipschitz constant 1
    double size;
    bool convex;
};

double cylinderValue(Vec3d p, double r, double h) { return std::max(std::hypot(p.x, p.z) - r, std::abs(p.y) - h / 2); }

double coneValue(Vec3d p, double bottom, double top, double h) {
    const double slant = std::hypot(h, bottom - top), cosine = h / slant;
    const double radius = bottom + (top - bottom) * (p.y / h + 0.5);
    return std::max((std::hypot(p.x, p.z) - radius) * cosine, std::abs(p.y) - h / 2);
}

double torusValue(Vec3d p, double major, double minor) { return std::hypot(std::hypot(p.x, p.z) - major, p.y) - minor; }

std::vector<Solid> solids() {
    std::vector<Solid> list;
    const auto frustum = [&](const char* name, double bottom, double top, double h) {
        list.push_back(
            {name, [=](const Transform& t) { return std::make_unique<Frustum>(bottom, top, h, true, t); },
             [=](Vec3d p) { return bottom == top ? cylinderValue(p, bottom, h) : coneValue(p, bottom, top, h); },
             std::hypot(std::max(bottom, top), h / 2), true});
    };
    frustum("cylinder", 0.8, 0.8, 1.5);
    frustum("coin", 1, 1, 0.02);
    frustum("rod", 0.01, 0.01, 2);
    frustum("cone", 1, 0, 1.6);
    frustum("cone upside down", 0, 0.5, 1);
    frustum("truncated cone", 0.4, 1, 0.7);
    const auto torus = [&](const char* name, double major, double minor) {
        list.push_back({name, [=](const Transform& t) { return std::make_unique<Torus>(major, minor, t); },
                        [=](Vec3d p) { return torusValue(p, major, minor); }, major + minor, false});
    };
    torus("torus", 1, 0.35);
    torus("thin torus", 1, 0.005);
    torus("horn torus", 0.7, 0.7);
    return list;
}

Vec3d unit(Random& random) {
    const auto u = [&] { return static_cast<double>(random.uniform()); };
    const double z = 2 * u() - 1, r = std::sqrt(1 - z * z), phi = 2 * kPiD * u();
    return {r * std::cos(phi), r * std::sin(phi), z};
}

// The first change of sign along the ray by steps that the distance allows, then bisection. Grazing rays that come
// closer than 1e-5 without entering count as undecided: NaN.
double march(const Solid& solid, Vec3d o, Vec3d d, double end) {
    double t = 0;
    const double start = solid.value(o);
    double least = std::numeric_limits<double>::infinity();
    const double smallest = 2e-6 * solid.size;
    while (t < end) {
        const double v = solid.value(o + d * t);
        if ((v < 0) != (start < 0)) {
            double a = t - smallest, b = t;
            for (int i = 0; i < 60; ++i) {
                const double mid = 0.5 * (a + b);
                ((solid.value(o + d * mid) < 0) == (start < 0) ? a : b) = mid;
            }
            return b;
        }
        least = std::min(least, std::abs(v));
        t += std::max(std::abs(v), smallest);
    }
    return least < 1e-5 * solid.size ? std::numeric_limits<double>::quiet_NaN()
                                     : std::numeric_limits<double>::infinity();
}

} // namespace

TEST_CASE("parametric shapes: rays meet them where marching in double does") {
    for (const Solid& solid : solids()) {
        const auto shape = solid.make(Transform{});
        const auto scene = intersectorOf(*shape);
        Random random(3);
        int hits = 0, misses = 0, undecided = 0, wrong = 0;
        double worst = 0, worstNormal = 0;
        for (int i = 0; i < 12000; ++i) {
            // From outside, from inside and from far away, at points in and near the shape.
            const double far = i % 8 == 7 ? 30 : 1.5;
            const Vec3d from = unit(random) * (i % 4 == 0 ? 0.4 * solid.size : far * solid.size);
            const Vec3d at = unit(random) * (solid.size * std::cbrt(static_cast<double>(random.uniform())));
            const Vec3 origin(from);
            const Vec3 direction(normalize(at - Vec3d(origin)));
            const Vec3d o(origin), d(direction);
            const double exact = march(solid, o, d, length(o) + 2 * solid.size);
            if (std::isnan(exact)) {
                ++undecided;
                continue;
            }
            SurfaceHit hit;
            const bool met = scene->intersect({origin, direction}, hit);
            if (met != std::isfinite(exact)) {
                ++wrong;
                continue;
            }
            if (!met) {
                ++misses;
                continue;
            }
            ++hits;
            const double across = std::abs(dot(d, Vec3d(hit.ng))); // the point is rounded along the normal too
            worst = std::max(worst,
                             std::abs(static_cast<double>(hit.distance) - exact) * across / (length(o) + solid.size));
            // The normal against the gradient of the distance, away from edges.
            constexpr double h = 1e-7;
            const Vec3d p = o + d * exact;
            const auto slope = [&](Vec3d e) { return (solid.value(p + e * h) - solid.value(p - e * h)) / (2 * h); };
            const Vec3d n{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
            if (std::abs(length(n) - 1) < 1e-3) worstNormal = std::max(worstNormal, length(n - Vec3d(hit.ng)));
        }
        INFO(solid.name << ": hits " << hits << " misses " << misses << " undecided " << undecided << " worst " << worst
                        << " normal " << worstNormal);
        CHECK(wrong == 0);
        CHECK(hits > 60);
        CHECK(misses > 500);
        CHECK(worst < 2e-7);
        CHECK(worstNormal < 2e-3);
    }
}

namespace {

// The surface as triangles, n along each of its two parameters; nearly exact, and flat.
MeshData tessellate(const std::vector<Vec2d>& profile, int n) {
    MeshData mesh;
    const auto rows = static_cast<std::uint32_t>(profile.size()), columns = static_cast<std::uint32_t>(n);
    for (const Vec2d& q : profile)
        for (int j = 0; j < n; ++j) {
            const double phi = 2 * kPiD * j / n;
            mesh.positions.push_back(Vec3(Vec3d{q.x * std::sin(phi), q.y, q.x * std::cos(phi)}));
        }
    for (std::uint32_t i = 0; i + 1 < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            const std::uint32_t k = (j + 1) % columns, a = i * columns, b = a + columns;
            mesh.triangles.push_back({a + j, a + k, b + k});
            mesh.triangles.push_back({a + j, b + k, b + j});
        }
    return mesh;
}

} // namespace

TEST_CASE("parametric shapes: a hundred thousand rays see what a dense mesh shows") {
    const int n = 600;
    std::vector<Vec2d> tube;
    for (int i = 0; i <= n; ++i) {
        const double angle = 2 * kPiD * (i % n) / n;
        tube.push_back({1 + 0.35 * std::cos(angle), 0.35 * std::sin(angle)});
    }
    const std::vector<Vec2d> truncated{{0, -0.35}, {0.4, -0.35}, {1, 0.35}, {0, 0.35}};
    const std::vector<Vec2d> cylinder{{0, -0.75}, {0.8, -0.75}, {0.8, 0.75}, {0, 0.75}};
    const Transform squash = Transform::scale({1, 0.4, -1.8})
                                 .then(Transform::rotate({1, 2, 0.5}, 1.1))
                                 .then(Transform::translate({3, -2, 5}));
    for (const Transform& place : {Transform{}, squash}) {
        std::vector<std::pair<std::unique_ptr<const Shape>, MeshData>> pairs;
        pairs.emplace_back(std::make_unique<Torus>(1, 0.35, place), tessellate(tube, n));
        pairs.emplace_back(std::make_unique<Frustum>(0.4, 1, 0.7, true, place), tessellate(truncated, 3000));
        pairs.emplace_back(std::make_unique<Frustum>(0.8, 0.8, 1.5, true, place), tessellate(cylinder, 3000));
        for (auto& [shape, mesh] : pairs) {
            for (Vec3& p : mesh.positions) p = Vec3(place.point(Vec3d(p)));
            const Mesh flat(mesh);
            CHECK(flat.area() == doctest::Approx(shape->area()).epsilon(1e-4));
            const Bounds3 a = flat.bounds(), b = shape->bounds();
            CHECK(length(a.lower - b.lower) < 1e-4f);
            CHECK(length(a.upper - b.upper) < 1e-4f);
            const auto scene = intersectorOf(*shape), reference = intersectorOf(flat);
            const Vec3d centre(b.centre());
            Random random(5);
            int wrong = 0, hits = 0, far = 0, uv = 0;
            for (int i = 0; i < 100000; ++i) {
                const Vec3d from = centre + unit(random) * 3.0;
                const Vec3d to = centre + unit(random) * static_cast<double>(random.uniform());
                const Ray ray{Vec3(from), Vec3(normalize(to - from))};
                SurfaceHit h, r;
                const bool met = scene->intersect(ray, h), expected = reference->intersect(ray, r);
                wrong += met != expected;
                if (!met || !expected) continue;
                ++hits;
                const double grazing = std::max(0.02, std::abs(static_cast<double>(dot(r.ng, ray.direction))));
                far += static_cast<double>(std::abs(h.distance - r.distance)) > 1e-4 / grazing;
                uv += !(h.uv.x >= 0 && h.uv.x <= 1 && h.uv.y >= 0 && h.uv.y <= 1);
            }
            INFO("hits " << hits << " wrong " << wrong << " far " << far);
            CHECK(hits > 20000);
            CHECK(wrong < 40); // at the outline only
            CHECK(far < 40);
            CHECK(uv == 0);
        }
    }
}

TEST_CASE("parametric shapes: rays that leave a convex one never meet it again") {
    // docs/hard_cases.md, cases 1, 2 and 8.
    for (const Solid& solid : solids())
        for (double distance : {0.0, 10.0, 1e3})
            for (double scale : {1.0, 1e-4, 1e4}) {
                const Transform place = Transform::scale({scale, 0.7 * scale, 1.3 * scale})
                                            .then(Transform::rotate({1, 1, 0.3}, 0.8))
                                            .then(Transform::translate({distance * scale, -distance * scale, 0}));
                const auto shape = solid.make(place);
                const auto scene = intersectorOf(*shape);
                Random random(9);
                int outside = 0, escaped = 0, tested = 0;
                const int n = distance == 0 && scale == 1 ? 100000 : 5000;
                for (int i = 0; i < n; ++i) {
                    const Vec3d from = place.point(unit(random) * (3 * solid.size));
                    const Vec3d to = place.point(unit(random) * (0.6 * solid.size));
                    SurfaceHit hit;
                    if (!scene->intersect({Vec3(from), Vec3(normalize(to - from))}, hit)) continue;
                    ++tested;
                    // Half of the directions graze the surface.
                    Vec3d w = unit(random);
                    const Vec3d normal(hit.ng);
                    if (i % 2 == 0) w = normalize(w - normal * (dot(w, normal) - 1e-4));
                    if (dot(w, normal) < 0) w = -w;
                    SurfaceHit again;
                    const Vec3 out(w), in(-w);
                    if (solid.convex) outside += scene->intersect({spawnOrigin(hit, out), out}, again);
                    // Inwards there is a way out. (Far away float positions are coarser than thin solids.)
                    if (distance < 100 && i % 2 == 1) escaped += !scene->intersect({spawnOrigin(hit, in), in}, again);
                }
                INFO(solid.name << " at " << distance << " scale " << scale << ", tested " << tested);
                CHECK(outside == 0);
                CHECK(escaped == 0);
                CHECK(tested > n / 200);
            }
}

TEST_CASE("parametric shapes: no ray from inside a closed one gets out") {
    for (const Solid& solid : solids()) {
        const auto shape = solid.make(Transform{});
        const auto scene = intersectorOf(*shape);
        Random random(15);
        int escaped = 0, tested = 0;
        for (int i = 0; i < 200000; ++i) {
            const Vec3d from{(2 * static_cast<double>(random.uniform()) - 1) * solid.size,
                             (2 * static_cast<double>(random.uniform()) - 1) * solid.size,
                             (2 * static_cast<double>(random.uniform()) - 1) * solid.size};
            if (!(solid.value(Vec3d(Vec3(from))) < -1e-6)) continue;
            ++tested;
            SurfaceHit hit;
            const Vec3 w(unit(random));
            escaped += !scene->intersect({Vec3(from), w}, hit) || !(dot(hit.ng, w) > -1e-3f);
        }
        INFO(solid.name);
        CHECK(tested > 2);
        CHECK(escaped == 0);
    }
}

TEST_CASE("torus: rays along its circles of symmetry, through its hole, on its planes, from far away") {
    const Torus torus(1, 0.25, Transform{});
    const auto scene = intersectorOf(torus);
    const auto distance = [&](Vec3 o, Vec3 d) {
        SurfaceHit hit;
        return scene->intersect({o, normalize(d)}, hit) ? hit.distance : -1.f;
    };
    CHECK(distance({0, 5, 0}, {0, -1, 0}) == -1);                    // the axis
    CHECK(distance({1, 5, 0}, {0, -1, 0}) == doctest::Approx(4.75)); // on top of the tube
    CHECK(distance({0, 0, 0}, {1, 0, 0}) == doctest::Approx(0.75));  // from the centre
    CHECK(distance({0, 0, 0}, {0, 1, 0}) == -1);                     // up through the hole
    CHECK(distance({-5, 0, 0}, {1, 0, 0}) == doctest::Approx(3.75)); // four roots
    CHECK(distance({-1, 0, 0}, {1, 0, 0}) == doctest::Approx(0.25)); // from inside the tube
    CHECK(distance({-5, 0.2501f, 0}, {1, 0, 0}) == -1);              // just above
    CHECK(distance({-5, 0.2499f, 0}, {1, 0, 0}) == doctest::Approx(4).epsilon(0.01));
    CHECK(distance({-1e4f, 0, 0}, {1, 0, 0}) == doctest::Approx(1e4 - 1.25)); // ten thousand radii
    // Tangent to the tube from far: hits become misses where they should, to the resolution of the origin.
    for (float r : {0.5f, 0.9f, 1.1f})
        for (float step : {-1e-3f, 1e-3f}) {
            const float top = std::sqrt(0.0625f - (r - 1) * (r - 1));
            CHECK((distance({r, std::isfinite(top) ? top + step : step, -1e4f}, {0, 0, 1}) > 0) ==
                  (distance({r, std::isfinite(top) ? top + step : step, -3}, {0, 0, 1}) > 0));
        }
    // A horn torus closes in its centre.
    const Torus horn(1, 1, Transform{});
    const auto hornScene = intersectorOf(horn);
    int through = 0;
    Random random(2);
    for (int i = 0; i < 10000; ++i) {
        SurfaceHit hit;
        const Vec3 o(random.uniform() * 0.2f - 0.1f, 3, random.uniform() * 0.2f - 0.1f);
        if (!hornScene->intersect({o, {0, -1, 0}}, hit)) continue;
        ++through;
        CHECK_UNARY(isFinite(hit.p) && isFinite(hit.ng) && std::abs(length(hit.ng) - 1) < 1e-5f);
    }
    CHECK(through > 9990);
}

TEST_CASE("frustum: open ends let rays through, and the inner side is met") {
    const Frustum tube(0.5, 0.5, 2, false, Transform{});
    const auto scene = intersectorOf(tube);
    SurfaceHit hit;
    CHECK_FALSE(scene->intersect({{0.2f, 5, 0}, {0, -1, 0}}, hit));
    CHECK_FALSE(scene->intersect({{0, 3, 0}, normalize(Vec3(0.1f, -1, 0))}, hit)); // in and out by the open ends
    REQUIRE(scene->intersect({{0, 1.5f, 0}, normalize(Vec3(0.4f, -1, 0))}, hit));
    CHECK(hit.p.y == doctest::Approx(0.25));
    CHECK(hit.uv.x == doctest::Approx(0.25));
    CHECK(hit.uv.y == doctest::Approx(0.625));
    CHECK(tube.area() == doctest::Approx(2 * kPiD * 0.5 * 2));
    CHECK(Frustum(0.5, 0.5, 2, true, Transform{}).area() == doctest::Approx(2.5 * kPiD));
    CHECK(Frustum(3, 0, 4, true, Transform::scale({2, 2, 2})).area() == doctest::Approx(4 * (9 + 15) * kPiD));
    CHECK(Torus(2, 0.5, Transform{}).area() == doctest::Approx(4 * kPiD * kPiD));
}

TEST_CASE("box: closed, outward, exact") {
    const Mesh box(boxMesh({-1, 0, 2}, {1, 3, 2.5}));
    CHECK(box.area() == doctest::Approx(2 * (2 * 3 + 2 * 0.5 + 3 * 0.5)));
    CHECK(box.bounds().lower == Vec3(-1, 0, 2));
    CHECK(box.bounds().upper == Vec3(1, 3, 2.5f));
    const auto scene = intersectorOf(box);
    Random random(4);
    int wrong = 0;
    for (int i = 0; i < 100000; ++i) { // from inside: the slabs say where
        const Vec3 o(1.9f * random.uniform() - 0.95f, 0.1f + 2.8f * random.uniform(), 2.05f + 0.4f * random.uniform());
        const Vec3d d = unit(random);
        double t = std::numeric_limits<double>::infinity();
        Vec3d n;
        const double lower[] = {-1, 0, 2}, upper[] = {1, 3, 2.5};
        for (int axis = 0; axis < 3; ++axis) {
            const double e = ((d[axis] > 0 ? upper : lower)[axis] - static_cast<double>(o[axis])) / d[axis];
            if (!(e < t)) continue;
            t = e;
            const double s = d[axis] > 0 ? 1 : -1;
            n = {axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
        }
        SurfaceHit hit;
        const bool met = scene->intersect({o, Vec3(d)}, hit);
        wrong +=
            !met || std::abs(static_cast<double>(hit.distance) - t) > 1e-5 * (1 + t) || dot(Vec3d(hit.ng), n) < 0.9;
    }
    CHECK(wrong < 5); // at edges either face may be named
}
