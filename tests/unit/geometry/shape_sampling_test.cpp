#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "shape_test_support.h"
#include "support/jacobian.h"
#include "support/whole_emitter.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

struct SampledShape {
    const char* name;
    std::unique_ptr<const Shape> shape;
    std::vector<Vec3> from;
};

MeshData roof() { // two quads and two triangles that meet at angles
    MeshData m;
    m.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 1, 0}, {-1, 1, 0}, {-1, 0, 1}, {1, 0, 1}};
    m.quads = {{0, 3, 2, 1}, {4, 5, 2, 3}};
    m.triangles = {{0, 4, 3}, {1, 2, 5}};
    return m;
}

std::vector<SampledShape> sampledShapes() {
    std::vector<SampledShape> list;
    const auto add = [&](const char* name, std::unique_ptr<const Shape> shape, std::vector<Vec3> from) {
        list.push_back({name, std::move(shape), std::move(from)});
    };
    // The last points see the rectangle far enough for area sampling.
    add("rectangle", std::make_unique<Quad>(Vec3(-1, 0, -2), Vec3(1, 0, -2), Vec3(1, 0, 2), Vec3(-1, 0, 2)),
        {{0.3f, 1, 0.4f}, {3, 0.5f, 1}, {-1, 2, -2}, {0.2f, 0.05f, 1}, {2, -1.5f, 5}, {9, 9, 9}});
    add("tilted rectangle", std::make_unique<Quad>(Vec3(0, 0, 0), Vec3(3, 4, 0), Vec3(3, 4, 2), Vec3(0, 0, 2)),
        {{2, 0, 1}, {-3, 3, 4}, {20, -10, 0}});
    add("parallelogram", std::make_unique<Quad>(Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(3, 1, 0), Vec3(1, 1, 0)),
        {{1, 1, 1}, {4, 0, 1}});
    add("bent quad", std::make_unique<Quad>(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1.3f, 1, 0.3f), Vec3(0, 1, 0)),
        {{0.5f, 0.5f, 2}, {-2, 1, 1.5f}});
    add("sphere", std::make_unique<Sphere>(Vec3d(1, 2, 3), 0.5),
        {{1, 2, 1}, {1.2f, 2.1f, 3.6f}, {40, 0, 0}, {1.1f, 2, 3}, {1, 2, 3}, {1.2f, 1.8f, 3.3f}});
    add("disk", std::make_unique<Disk>(Vec3d(0, 1, 0), Vec3d(1, 2, 0.5), 0.7), {{0, 0, 0}, {2, 2, 1}, {0, 5, -6}});
    const Transform squash = Transform::scale({1, 0.3, 2}).then(Transform::rotate({1, 1, 0}, 0.7));
    add("ellipsoid", std::make_unique<Transformed>(std::make_unique<Sphere>(Vec3d(0.5, 0, 0), 1.0), squash),
        {{3, 1, 1}, {0.3f, 0.1f, 0.2f}, {-1, 4, 0}});
    add("ellipse", std::make_unique<Transformed>(std::make_unique<Disk>(Vec3d(0, 0, 0), Vec3d(0, 1, 1), 1.0), squash),
        {{1, 2, 1}, {-2, 0.5f, 1}});
    add("mesh", std::make_unique<WholeEmitter>(std::make_unique<Mesh>(roof())),
        {{0.2f, 3, 0.5f}, {0.1f, 0.3f, 0.1f}, {4, 1, 2}});
    MeshData lone;
    lone.positions = {{-1, 0, -2}, {1, 0, -2}, {1, 0, 2}, {-1, 0, 2}};
    lone.quads = {{0, 1, 2, 3}};
    add("mesh of one quad", std::make_unique<Mesh>(lone), {{0.3f, 1, 0.4f}});
    return list;
}

// The Jacobian, unless a seam of the map (the edge of a face, a fold of the square) is within the steps: there the
// steps forwards and backwards differ.
template <typename Map> std::optional<double> smoothJacobian(Map&& map, Vec2 u) {
    constexpr float h = 2e-3f;
    const auto at = map(u);
    for (Vec2 step : {Vec2{h, 0}, Vec2{0, h}}) {
        const auto before = map(u - step), after = map(u + step);
        if (!at || !before || !after) return std::nullopt;
        const Vec3d a = *after - *at, b = *at - *before;
        if (length(a - b) > 0.05 * std::max(length(a), length(b))) return std::nullopt;
    }
    return jacobian(map, u, h);
}

} // namespace

TEST_CASE("shapes: samples follow the density that rays find") {
    for (const SampledShape& c : sampledShapes())
        for (Vec3 from : c.from) {
            INFO(c.name << " from " << from.x << " " << from.y << " " << from.z);
            const bool hidden = std::string(c.name) == "mesh"; // faces of a roof hide one another
            const SamplingReport r = examine(*c.shape, from, hidden);
            INFO("integral " << r.pdfIntegral << " p " << r.chiSquareP << " pdf ratio " << r.worstPdfRatio << " missed "
                             << r.missed);
            CHECK(r.pdfIntegral == doctest::Approx(1).epsilon(3e-3)); // the grid of rays cuts the outline
            CHECK(r.chiSquareP > 1e-4);
            CHECK(r.samples > 39000);
            if (!hidden) CHECK(r.missed < 1e-3);
            CHECK(r.worstPdfRatio < 2e-2);
        }
}

TEST_CASE("shapes: density is one over the Jacobian of the map") {
    for (const SampledShape& c : sampledShapes())
        for (Vec3 from : c.from) {
            INFO(c.name << " from " << from.x << " " << from.y << " " << from.z);
            Random random(5);
            int compared = 0;
            double worst = 0;
            const auto direction = [&](Vec2 u) -> std::optional<Vec3d> {
                const auto s = c.shape->sampling()->sample(from, 0, u);
                if (!s) return std::nullopt;
                return normalize(Vec3d(s->p) - Vec3d(from));
            };
            for (int i = 0; i < 400; ++i) {
                const Vec2 u{0.02f + 0.96f * random.uniform(), 0.02f + 0.96f * random.uniform()};
                const auto s = c.shape->sampling()->sample(from, 0, u);
                const auto area = smoothJacobian(direction, u);
                if (!s || !area) continue;
                worst = std::max(worst, std::abs(*area * static_cast<double>(s->pdfSolidAngle) - 1));
                ++compared;
            }
            CHECK(compared > 100);
            CHECK(worst < 0.02);
        }
}

TEST_CASE("shapes: area") {
    const Sphere sphere(Vec3d(), 2);
    CHECK(sphere.area() == doctest::Approx(16 * kPiD));
    const Disk disk(Vec3d(), Vec3d(0, 0, 1), 2);
    CHECK(disk.area() == doctest::Approx(4 * kPiD));
    // A spheroid with semi-axes 1, 1, 2 [closed form].
    const Transformed spheroid(std::make_unique<Sphere>(Vec3d(), 1.0), Transform::scale({1, 1, 2}));
    const double e = std::sqrt(1 - 0.25);
    CHECK(spheroid.area() == doctest::Approx(2 * kPiD * (1 + 2 / e * std::asin(e))).epsilon(1e-5));
    const Transformed ellipse(std::make_unique<Disk>(Vec3d(), Vec3d(0, 0, 1), 1.0), Transform::scale({3, 2, 7}));
    CHECK(ellipse.area() == doctest::Approx(6 * kPiD));
    CHECK(Mesh(roof()).area() == doctest::Approx(4 * std::sqrt(2.0) + 2));
    CHECK(std::isinf(Plane(Vec3d(), Vec3d(0, 1, 0)).area()));
    CHECK(Plane(Vec3d(), Vec3d(0, 1, 0)).sampling() == nullptr);
}

TEST_CASE("quad: irradiance under a rectangle") {
    // Configuration factor of a rectangle parallel to a plane element, one corner straight above it
    // [Howell2010]; four of them make any rectangle.
    const auto corner = [](double a, double b, double h) {
        const double x = a / h, y = b / h, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
        return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * kPiD);
    };
    for (double h : {0.05, 0.5, 2.0, 20.0})
        for (double x : {0.0, 0.9, 3.0}) {
            const double ax = -1 - x, bx = 1 - x, az = -0.5, bz = 0.5;
            const auto signedCorner = [&](double a, double b) {
                return std::copysign(1.0, a) * std::copysign(1.0, b) * corner(std::abs(a), std::abs(b), h);
            };
            const double exact =
                signedCorner(bx, bz) - signedCorner(ax, bz) - signedCorner(bx, az) + signedCorner(ax, az);
            const auto y = static_cast<float>(h);
            const Quad quad({-1, y, -0.5f}, {1, y, -0.5f}, {1, y, 0.5f}, {-1, y, 0.5f});
            const Vec3 from(static_cast<float>(x), 0, 0);
            Random random(3);
            Moments m;
            for (int i = 0; i < 100000; ++i) {
                const auto s = quad.sample(from, 0, {random.uniform(), random.uniform()});
                const Vec3 w = normalize(s->p - from);
                m.add(static_cast<double>(w.y / s->pdfSolidAngle) / kPiD);
            }
            INFO("height " << h << " x " << x << " exact " << exact << " mean " << m.mean());
            CHECK(std::abs(m.mean() - exact) < 3 * m.standardError() + 2e-5 * exact);
        }
}

TEST_CASE("shapes: no point of view breaks a sampler") {
    // docs/hard_cases.md, cases 30 and 32: on the surface, at corners, on edges, in the plane, behind, inside, far.
    Random random(11);
    for (const SampledShape& c : sampledShapes()) {
        const Bounds3 b = c.shape->bounds();
        std::vector<Vec3> points{b.lower, b.upper, b.centre(), {1e6f, -1e6f, 1e6f}, {1e15f, 0, 0}, {1e-20f, 0, 0}};
        for (int i = 0; i < 200; ++i) { // on the surface itself, and just off it
            const auto s = c.shape->sampling()->sample(Vec3{3, 5, 7}, 0, {random.uniform(), random.uniform()});
            if (!s) continue;
            points.push_back(s->p);
            points.push_back(s->p + s->ng * 1e-7f);
            points.push_back(s->p - s->ng * 1e-30f);
        }
        for (Vec3 from : points)
            for (int i = 0; i < 20; ++i) {
                const Vec2 u{i == 0   ? 0.f
                             : i == 1 ? kOneMinusEpsilon
                                      : random.uniform(),
                             i == 2   ? 0.f
                             : i == 3 ? kOneMinusEpsilon
                                      : random.uniform()};
                const auto s = c.shape->sampling()->sample(from, 0, u);
                if (!s) continue;
                INFO(c.name << " from " << from.x << " " << from.y << " " << from.z);
                REQUIRE(isFinite(s->p));
                REQUIRE(isFinite(s->pError));
                REQUIRE(std::isfinite(s->pdfSolidAngle));
                REQUIRE(s->pdfSolidAngle > 0);
                REQUIRE(length(s->ng) == doctest::Approx(1).epsilon(1e-4));
                SurfaceHit hit;
                hit.p = s->p;
                hit.ng = s->ng;
                const float pdf = c.shape->sampling()->pdfSolidAngle(from, hit);
                REQUIRE(std::isfinite(pdf));
                REQUIRE(pdf >= 0);
            }
    }
}

TEST_CASE("sphere: the cone keeps its digits when the sphere is small") {
    // docs/hard_cases.md, case 30: 1 - cos θ from the sine, not from the cosine.
    for (double theta : {1e-7, 1e-5, 1e-3, 0.1, 1.0, 1.5}) {
        const double distance = 1 / std::sin(theta);
        const Sphere sphere({distance, 0, 0}, 1);
        const double exact = 2 * kPiD * 2 * square(std::sin(theta / 2));
        CHECK(1 / static_cast<double>(sphere.pdfSolidAngle(Vec3{0, 0, 0}, {})) == doctest::Approx(exact).epsilon(1e-6));
    }
}
