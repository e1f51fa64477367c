// Rectangles, spheres and polygons of meshes sampled for receivers, most of them lit from one side: densities over the
// directions, and what they are good for.
#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "support/chi_square.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <functional>

namespace abbe::test {
namespace {

struct Case {
    const char* name;
    Receiver from;
    double least = 1; // of the integral of the density: the rest is below the horizon
};

// The first point of the shape in a direction, if any.
using Trace = std::function<std::optional<Vec3d>(Vec3d o, Vec3d w)>;

std::optional<Vec3d> traceQuad(Vec3d o, Vec3d w) { // [-1, 1]² at y = 1
    const double t = (1 - o.y) / w.y;
    if (!(t > 0)) return std::nullopt;
    const Vec3d p = o + w * t;
    if (std::abs(p.x) > 1 || std::abs(p.z) > 1) return std::nullopt;
    return p;
}

std::optional<Vec3d> traceSphere(Vec3d o, Vec3d w) { // about (0, 2, 0), radius 1
    const Vec3d d = Vec3d(0, 2, 0) - o;
    const double b = dot(d, w), q = b * b - (lengthSquared(d) - 1);
    if (!(q > 0)) return std::nullopt;
    const double t = b - std::sqrt(q);
    return t > 0 ? std::optional(o + w * t) : std::nullopt;
}

// Two triangles, the first of which is sampled, or two quads.
Mesh meshOf(std::array<Vec3, 3> p) {
    MeshData data;
    data.positions = {p[0], p[1], p[2], p[2] + Vec3{9, 9, 9}, p[2] + Vec3{9, 9, 8}};
    data.triangles = {{0, 1, 2}, {2, 3, 4}};
    return Mesh(std::move(data));
}
Mesh meshOf(std::array<Vec3, 4> p) {
    MeshData data;
    data.positions = {p[0], p[1], p[2], p[3], p[0] + Vec3{9, 9, 9}, p[1] + Vec3{9, 9, 9}};
    data.quads = {{0, 1, 2, 3}, {0, 1, 5, 4}};
    return Mesh(std::move(data));
}

// The nearest point of the triangles in a direction.
Trace traceTriangles(std::vector<std::array<Vec3, 3>> triangles) {
    return [triangles](Vec3d o, Vec3d w) {
        std::optional<Vec3d> found;
        for (const auto& [p0, p1, p2] : triangles) {
            const Vec3d a(p0), s = Vec3d(p1) - a, t = Vec3d(p2) - a, n = cross(s, t);
            const double along = dot(a - o, n) / dot(w, n);
            const Vec3d p = o + w * along, d = p - a;
            const double x = dot(cross(d, t), n) / dot(n, n), y = dot(cross(s, d), n) / dot(n, n);
            if (along > 0 && x >= 0 && y >= 0 && x + y <= 1) found = p;
        }
        return found;
    };
}

// Chi-square over cells of the sphere of directions, the integral of the density, and that sample() and
// pdfSolidAngle() agree.
void check(const Shape& shape, const Trace& trace, const Case& c) {
    CAPTURE(c.name);
    constexpr int kRows = 24, kColumns = 48, kFine = 20, kSamples = 200000;
    const auto cell = [](Vec3d w) {
        const double phi = std::atan2(w.y, w.x);
        const int row = std::clamp(static_cast<int>((w.z + 1) / 2 * kRows), 0, kRows - 1);
        const int column = std::clamp(static_cast<int>((phi / kPiD + 1) / 2 * kColumns), 0, kColumns - 1);
        return static_cast<std::size_t>(row * kColumns + column);
    };
    std::vector<double> expected(kRows * kColumns + 1, 0.0), observed(expected.size(), 0.0);
    double integral = 0;
    for (int i = 0; i < kRows * kFine; ++i)
        for (int j = 0; j < kColumns * kFine; ++j) {
            const double z = 2 * (i + 0.5) / (kRows * kFine) - 1, phi = (2 * (j + 0.5) / (kColumns * kFine) - 1) * kPiD;
            const double r = std::sqrt(1 - z * z);
            const Vec3d w(r * std::cos(phi), r * std::sin(phi), z);
            const auto p = trace(Vec3d(c.from.p), w);
            if (!p) continue;
            SurfaceHit hit;
            hit.p = Vec3(*p);
            hit.ng = {0, -1, 0};
            const double share = static_cast<double>(shape.sampling()->pdfSolidAngle(c.from, hit)) * 4 * kPiD /
                                 (kRows * kColumns * kFine * kFine);
            integral += share;
            expected[cell(w)] += share * kSamples;
        }
    Random random(21);
    double worst = 0;
    for (int i = 0; i < kSamples; ++i) {
        const auto s = shape.sampling()->sample(c.from, 0, {random.uniform(), random.uniform()});
        if (!s) {
            ++observed.back();
            continue;
        }
        const Vec3d w = normalize(Vec3d(s->p) - Vec3d(c.from.p));
        ++observed[cell(w)];
        SurfaceHit hit;
        hit.p = s->p;
        hit.ng = s->ng;
        // Where the density all but vanishes its relative error means nothing.
        const auto pdf = static_cast<double>(shape.sampling()->pdfSolidAngle(c.from, hit));
        worst = std::max(worst, std::abs(pdf - static_cast<double>(s->pdfSolidAngle)));
    }
    CHECK(integral == doctest::Approx(c.least).epsilon(0.004));
    CHECK(worst < 2e-3);
    expected.back() = std::max(1e-3, (1 - integral) * kSamples);
    // The rays of a cell that the outline crosses miss some of it: such cells are left to their neighbours.
    for (std::size_t k = 0; k + 1 < expected.size(); ++k)
        if (expected[k] < 200) {
            expected.back() += expected[k];
            observed.back() += observed[k];
            expected[k] = observed[k] = 0;
        }
    double statistic = 0; // of cells, with 2 % for the quadrature
    for (std::size_t k = 0; k + 1 < expected.size(); ++k) {
        const double e = expected[k], tolerance = 0.04 * e;
        if (e > 0) statistic = std::max(statistic, (std::abs(observed[k] - e) - tolerance) / std::sqrt(e));
    }
    CHECK(statistic < 5);
}

const Quad kQuad({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1});
const Sphere kSphere({0, 2, 0}, 1);

} // namespace

TEST_CASE("quad: sampled by the cosine at the receiver") {
    check(kQuad, traceQuad, {"below the middle", {{0, 0, 0}, {0, 1, 0}, false}});
    check(kQuad, traceQuad, {"near a corner", {{0.9f, 0.7f, 0.9f}, normalize(Vec3{0.3f, 1, 0}), false}});
    check(kQuad, traceQuad, {"cut by the horizon", {{0.2f, 0.5f, 0.1f}, normalize(Vec3{1, 0.1f, 0}), false}});
    check(kQuad, traceQuad, {"beside it", {{1.5f, 0.2f, 0}, {-1, 0, 0}, false}});
    check(kQuad, traceQuad, {"both sides count", {{0.2f, 0.5f, 0.1f}, {1, 0, 0}, true}});
}

TEST_CASE("sphere: sampled by the cosine at the receiver") {
    check(kSphere, traceSphere, {"straight below", {{0, 0.5f, 0}, {0, 1, 0}, false}});
    check(kSphere, traceSphere, {"from the side", {{0.5f, 0.2f, 0.3f}, normalize(Vec3{0.4f, 1, 0}), false}});
    check(kSphere, traceSphere, {"just above the horizon", {{0, 0, 0}, normalize(Vec3{1, 0.62f, 0}), false}});
    check(kSphere, traceSphere, {"cut by the horizon", {{0, 0, 0}, normalize(Vec3{1, 0.4f, 0}), false}});
    check(kSphere, traceSphere, {"cut in the middle", {{0, 0, 0}, {1, 0, 0}, false}});
    check(kSphere, traceSphere,
          {"its centre below the horizon", {{0, 0.8f, 0}, normalize(Vec3{1, -0.5f, 0.2f}), false}});
    check(kSphere, traceSphere, {"near its surface", {{0, 0.99f, 0}, normalize(Vec3{1, 0.3f, 0}), false}});
    check(kSphere, traceSphere, {"a touch of the horizon", {{0, 0, 0}, normalize(Vec3{1, 0.5773f, 0}), false}});
    check(kSphere, traceSphere, {"both sides count", {{0, 0.5f, 0}, {1, 0, 0}, true}});
}

// docs/hard_cases.md, case 31.
TEST_CASE("triangles of a mesh: sampled per solid angle and by the cosine") {
    const std::array<Vec3, 3> flat{Vec3{-1, 1, -1}, Vec3{0.2f, 1, 1}, Vec3{1, 1, -1}};
    const Mesh mesh = meshOf(flat);
    const Trace trace = traceTriangles({flat});
    check(mesh, trace, {"below, from everywhere", {Vec3{0, 0, 0}}});
    check(mesh, trace, {"near an edge", {Vec3{0.4f, 0.7f, -0.9f}}});
    check(mesh, trace, {"below, by the cosine", {{0, 0, 0}, {0, 1, 0}, false}});
    check(mesh, trace, {"near a corner", {{0.9f, 0.7f, -0.9f}, normalize(Vec3{0.3f, 1, 0}), false}});
    check(mesh, trace, {"cut by the horizon", {{0.1f, 0.5f, 0.1f}, normalize(Vec3{1, 0.1f, 0}), false}});
    check(mesh, trace, {"beside it", {{1.4f, 0.3f, -0.5f}, {-1, 0, 0}, false}});
    const std::array<Vec3, 3> sliver{Vec3{-3, 1, 0}, Vec3{3, 1, 0.3f}, Vec3{0, 1.2f, 0.5f}};
    check(meshOf(sliver), traceTriangles({sliver}), {"a long one", {{0, 0, 0}, {0, 1, 0}, false}});
}

TEST_CASE("quads of a mesh: both halves sampled per solid angle and by the cosine") {
    const std::array<Vec3, 4> flat{Vec3{-1, 1, -1}, Vec3{-1, 1, 0.5f}, Vec3{0.8f, 1, 1}, Vec3{1, 1, -0.6f}},
        bent{Vec3{-1, 1, -1}, Vec3{-1, 1, 1}, Vec3{1, 1.3f, 1}, Vec3{1, 1, -1}};
    for (const auto& q : {flat, bent}) {
        const Mesh mesh = meshOf(q);
        const Trace trace = traceTriangles({{q[0], q[1], q[3]}, {q[2], q[3], q[1]}});
        check(mesh, trace, {"below, from everywhere", {Vec3{0, 0, 0}}});
        check(mesh, trace, {"below, by the cosine", {{0.3f, 0.2f, 0}, normalize(Vec3{0.3f, 1, 0}), false}});
        check(mesh, trace, {"cut by the horizon", {{0.1f, 0.5f, 0.1f}, normalize(Vec3{1, 0.1f, 0}), false}});
    }
}

// What it is for: near a large light the cosine is all that varies.
TEST_CASE("the spread of irradiance estimates falls by the cosine") {
    const auto moments = [](const Shape& shape, const Receiver& at, Vec3 n) {
        Random random(5);
        Moments m;
        for (int i = 0; i < 100000; ++i) {
            const auto s = shape.sampling()->sample(at, 0, {random.uniform(), random.uniform()});
            m.add(s ? std::max(0.f, dot(normalize(s->p - at.p), n)) / s->pdfSolidAngle : 0);
        }
        return m;
    };
    const Vec3 up{0, 1, 0};
    // The corners tell nothing of a maximum between them: right below the middle nothing is gained.
    struct Place {
        Receiver at;
        double most; // of the variance that is left
    };
    for (const auto& [at, most] :
         {Place{{{0, 0, 0}, up, false}, 1.001}, Place{{{0.8f, 0.6f, -0.5f}, up, false}, 0.6},
          Place{{{1.5f, 0.2f, 0}, {-1, 0, 0}, false}, 0.3}, Place{{{0, 0.2f, 0.3f}, {0, 0, -1}, false}, 0.35}}) {
        const Moments with = moments(kQuad, at, at.n), without = moments(kQuad, at.p, at.n);
        CHECK(with.mean() == doctest::Approx(without.mean()).epsilon(0.01));
        MESSAGE("quad: variance ", with.variance() / without.variance());
        CHECK(with.variance() < most * without.variance());
    }
    const Mesh mesh = meshOf(std::array{Vec3{-1, 1, -1}, Vec3{0.2f, 1, 1}, Vec3{1, 1, -1}});
    for (const auto& [at, most] :
         {Place{{{0.8f, 0.6f, -0.5f}, up, false}, 0.7}, Place{{{1.5f, 0.2f, 0}, {-1, 0, 0}, false}, 0.4}}) {
        const Moments with = moments(mesh, at, at.n), without = moments(mesh, at.p, at.n);
        CHECK(with.mean() == doctest::Approx(without.mean()).epsilon(0.01));
        MESSAGE("triangle: variance ", with.variance() / without.variance());
        CHECK(with.variance() < most * without.variance());
    }
    for (const Vec3 p : {Vec3{0, 0.8f, 0}, Vec3{0.5f, 0.2f, 0}}) {
        const Moments with = moments(kSphere, {p, up, false}, up), without = moments(kSphere, p, up);
        CHECK(with.mean() == doctest::Approx(without.mean()).epsilon(0.01));
        CHECK(with.variance() < 1e-6 * without.mean() * without.mean()); // none is left
    }
    // Crossing the horizon: the same light.
    for (const Vec3 n : {normalize(Vec3{1, 0.1f, 0}), normalize(Vec3{1, -0.3f, 0.2f})}) {
        const Vec3 p{0.2f, 0.5f, 0.1f};
        const Moments with = moments(kQuad, {p, n, false}, n), without = moments(kQuad, p, n);
        CHECK(std::abs(with.mean() - without.mean()) < 5 * std::hypot(with.standardError(), without.standardError()));
        CHECK(with.variance() < without.variance());
    }
}

// docs/hard_cases.md, cases 30 and 32.
TEST_CASE("receivers in, on, above and far from a light do no harm") {
    Random random(8);
    const auto sound = [&random](const Shape& shape, const Receiver& at) {
        for (int i = 0; i < 200; ++i) {
            const auto s = shape.sampling()->sample(at, 0, {random.uniform(), random.uniform()});
            if (!s) continue;
            CHECK_UNARY(isFinite(s->p) && isFinite(s->ng) && isFinite(s->pdfSolidAngle) && s->pdfSolidAngle > 0);
            SurfaceHit hit;
            hit.p = s->p;
            hit.ng = s->ng;
            const float pdf = shape.sampling()->pdfSolidAngle(at, hit);
            CHECK_UNARY(isFinite(pdf) && pdf >= 0);
        }
    };
    const Mesh mesh = meshOf(std::array{Vec3{-1, 1, -1}, Vec3{0.2f, 1, 1}, Vec3{1, 1, -1}});
    const Mesh quads = meshOf(std::array{Vec3{-1, 1, -1}, Vec3{-1, 1, 1}, Vec3{1, 1, 1}, Vec3{1, 1, -1}});
    const float far = 1e7f;
    for (const Vec3 p : {Vec3{0, 1, 0}, Vec3{1, 1, 1}, Vec3{1, 1, 0}, Vec3{0, 2, 0}, Vec3{0, 1 - 1e-7f, 0},
                         Vec3{0, -far, 0}, Vec3{far, 1, 0}, Vec3{1, 2, 0}, Vec3{0, 3, 0}, Vec3{0, 1.0001f, 0}})
        for (const Vec3 n : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1, 0, 0}, normalize(Vec3{1, 1e-6f, 0})})
            for (const bool both : {false, true}) {
                sound(kQuad, {p, n, both});
                sound(kSphere, {p, n, both});
                sound(mesh, {p, n, both});
                sound(quads, {p, n, both});
            }
    // A tiny light, as wide as 1e-7 rad: its density is that of its solid angle.
    for (const double r : {1e-7, 1e-4, 1e-2}) {
        const Sphere tiny({0, 1, 0}, r);
        const auto s = tiny.sample(Receiver({0, 0, 0}, {0, 1, 0}, false), 0, {0.3f, 0.6f});
        REQUIRE(s);
        const double c = std::sqrt(1 - r * r);
        CHECK(static_cast<double>(s->pdfSolidAngle) * 2 * kPiD * r * r / (1 + c) == doctest::Approx(1).epsilon(1e-6));
    }
}

} // namespace abbe::test
