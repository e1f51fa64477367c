// Cylinders, cones and tori as lights: densities of samples, and the light that they give.
#include "geometry/flat_shapes.h"
#include "geometry/frustum.h"
#include "geometry/mesh.h"
#include "geometry/torus.h"
#include "shape_test_support.h"
#include "support/jacobian.h"
#include "support/whole_emitter.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe;
using namespace abbe::test;

namespace {

struct ParametricCase {
    std::string name;
    std::unique_ptr<const Shape> shape;
};

std::vector<ParametricCase> parametricCases() {
    const Transform squash =
        Transform::scale({1, 0.3, -2}).then(Transform::rotate({1, 1, 0}, 0.7)).then(Transform::translate({0.2, 0, 1}));
    std::vector<ParametricCase> list;
    const auto add = [&](const char* name, auto make) {
        list.push_back({name, make(Transform{})});
        list.push_back({name, make(squash)});
    };
    add("cylinder", [](const Transform& t) { return std::make_unique<Frustum>(0.8, 0.8, 1.5, true, t); });
    add("tube", [](const Transform& t) { return std::make_unique<Frustum>(0.8, 0.8, 1.5, false, t); });
    add("cone", [](const Transform& t) { return std::make_unique<Frustum>(1, 0, 1.6, true, t); });
    add("truncated cone", [](const Transform& t) { return std::make_unique<Frustum>(0.4, 1, 0.7, true, t); });
    add("torus", [](const Transform& t) { return std::make_unique<Torus>(1, 0.35, t); });
    add("horn torus", [](const Transform& t) { return std::make_unique<Torus>(0.7, 0.7, t); });
    list.push_back(
        {"box", std::make_unique<WholeEmitter>(std::make_unique<Mesh>(boxMesh({-1, -0.5, 0}, {1, 0.5, 0.3})))});
    return list;
}

// Area sampling has a density per solid angle that grows beyond all bounds towards the outline, and no grid of rays
// integrates that. Weighted by the cosine it is tame: per cell of directions, the mean cosine of the samples there
// against the integral of density times cosine over all hits of all rays.
struct WeightedReport {
    double chiSquare = 0;
    int cells = 0;
    double worstPdfRatio = 0;
    double totalError = 0;
};

WeightedReport examineWeighted(const Shape& shape, Vec3 from) {
    constexpr int cells = 10, rays = 50, n = cells * rays, samples = 60000;
    const auto scene = intersectorOf(shape);
    const DirectionSquare directions(shape.bounds(), from);
    std::vector<double> expected(cells * cells, 0.0);
    double totalExpected = 0;
    const auto at = [](int i, int j) { return static_cast<std::size_t>(i * cells + j); };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec3 w(directions.direction((i + 0.5) / n, (j + 0.5) / n));
            Ray ray{from, w};
            for (int hits = 0; hits < 8; ++hits) {
                SurfaceHit hit;
                if (!scene->intersect(ray, hit)) break;
                const double value =
                    static_cast<double>(shape.sampling()->pdfSolidAngle(from, hit) * std::abs(dot(hit.ng, w))) *
                    directions.solidAngle() / (double(n) * n);
                expected[at(i / rays, j / rays)] += value;
                totalExpected += value;
                ray.origin = spawnOrigin(hit, w);
            }
        }
    std::vector<double> sum(cells * cells, 0.0), squares(cells * cells, 0.0);
    WeightedReport report;
    Random random(17);
    double total = 0;
    for (int i = 0; i < samples; ++i) {
        const Vec2 u{random.uniform(), random.uniform()};
        const auto s = shape.sampling()->sample(from, 0, u);
        if (!s) continue;
        const Vec3d d = normalize(Vec3d(s->p) - Vec3d(from));
        const Vec2d q = directions.square(d);
        const double weight = std::abs(dot(d, Vec3d(s->ng)));
        const auto cell = [](double x) { return std::clamp(static_cast<int>(x * cells), 0, cells - 1); };
        sum[at(cell(q.x), cell(q.y))] += weight;
        squares[at(cell(q.x), cell(q.y))] += square(weight);
        total += weight;
        SurfaceHit hit;
        hit.p = s->p;
        hit.ng = s->ng;
        if (const auto* whole = dynamic_cast<const WholeEmitter*>(&shape)) hit.primitive = whole->partOf(u.x);
        const double ratio = static_cast<double>(shape.sampling()->pdfSolidAngle(from, hit) / s->pdfSolidAngle);
        report.worstPdfRatio = std::max(report.worstPdfRatio, std::abs(ratio - 1));
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double mean = sum[i] / samples, variance = (squares[i] / samples - square(mean)) / samples;
        if (!(expected[i] > 1e-3)) continue; // the outline only touches it
        ++report.cells;
        report.chiSquare += square(mean - expected[i]) / (variance + square(0.004 * expected[i]));
    }
    report.totalError = total / samples / totalExpected - 1;
    return report;
}

} // namespace

TEST_CASE("parametric shapes: samples follow the density that rays find") {
    for (const ParametricCase& c : parametricCases())
        for (Vec3 from : {Vec3(3, 2, 1), Vec3(-1.5f, 3, -2.5f), Vec3(0.1f, -4, 6)}) {
            INFO(c.name << " from " << from.x << " " << from.y << " " << from.z);
            const WeightedReport r = examineWeighted(*c.shape, from);
            INFO("chi² " << r.chiSquare << " of " << r.cells << " pdf " << r.worstPdfRatio << " total "
                         << r.totalError);
            CHECK(r.chiSquare < r.cells + 4.5 * std::sqrt(2.0 * r.cells));
            CHECK(r.cells > 8);
            CHECK(std::abs(r.totalError) < 0.01);
            CHECK(r.worstPdfRatio < 1e-4);
        }
}

TEST_CASE("parametric shapes: density is one over the Jacobian of the map") {
    for (const ParametricCase& c : parametricCases()) {
        if (c.name == "box") continue;
        const Vec3 from(3, 2, 1);
        Random random(5);
        int compared = 0, off = 0;
        const auto direction = [&](Vec2 u) -> std::optional<Vec3d> {
            const auto s = c.shape->sampling()->sample(from, 0, u);
            if (!s) return std::nullopt;
            return normalize(Vec3d(s->p) - Vec3d(from));
        };
        for (int i = 0; i < 1000; ++i) {
            const Vec2 u{0.02f + 0.96f * random.uniform(), 0.02f + 0.96f * random.uniform()};
            const auto s = c.shape->sampling()->sample(from, 0, u);
            // Edge-on the direction turns back within the steps of the difference.
            if (!s || std::abs(dot(normalize(s->p - from), s->ng)) < 0.2f) continue;
            const auto area = jacobian(direction, u, 1e-3f);
            if (!area) continue;
            ++compared;
            off += std::abs(*area * static_cast<double>(s->pdfSolidAngle) - 1) > 0.02;
        }
        INFO(c.name << " compared " << compared << " off " << off);
        CHECK(compared > 300);
        CHECK(off * 50 < compared); // steps across the seam between side and cap
    }
}

TEST_CASE("parametric shapes: irradiance by samples of the light and by rays agree") {
    for (const ParametricCase& c : parametricCases()) {
        const Vec3 from(1, 0.5f, 3.5f), n = normalize(Vec3(-0.3f, -0.1f, -1));
        const auto scene = intersectorOf(*c.shape);
        const DirectionSquare directions(c.shape->bounds(), from);
        Random random(6);
        Moments byLight, byRays;
        for (int i = 0; i < 60000; ++i) {
            const Vec2 u{random.uniform(), random.uniform()};
            double value = 0;
            SurfaceHit hit;
            // A one-sided emitter of radiance 1: only what faces the point and is not behind something else counts.
            if (const auto s = c.shape->sampling()->sample(from, 0, u)) {
                const Vec3 d = s->p - from, w = normalize(d);
                if (dot(w, s->ng) < 0 && dot(w, n) > 0) {
                    const Ray shadow{from, w, length(d) * 0.9999f};
                    if (!scene->occluded(shadow)) value = static_cast<double>(dot(w, n) / s->pdfSolidAngle);
                }
            }
            byLight.add(value);
            const Vec3 w(directions.direction(random.uniform(), random.uniform()));
            value = 0;
            if (dot(w, n) > 0 && scene->intersect({from, w}, hit) && dot(hit.ng, w) < 0)
                value = static_cast<double>(dot(w, n)) * directions.solidAngle();
            byRays.add(value);
        }
        const double error = std::hypot(byLight.standardError(), byRays.standardError());
        INFO(c.name << " lamp " << byLight.mean() << " rays " << byRays.mean() << " error " << error);
        CHECK(byRays.mean() > 0);
        CHECK(std::abs(byLight.mean() - byRays.mean()) < 4 * error + 1e-4 * byRays.mean());
    }
}

TEST_CASE("parametric shapes: no point of view breaks a sampler") {
    Random random(11);
    for (const ParametricCase& c : parametricCases()) {
        const Bounds3 b = c.shape->bounds();
        std::vector<Vec3> points{b.lower, b.upper, b.centre(), {0, 0, 0}, {1e6f, -1e6f, 1e6f}, {1e15f, 0, 0}};
        for (int i = 0; i < 100; ++i)
            if (const auto s = c.shape->sampling()->sample(Vec3{3, 5, 7}, 0, {random.uniform(), random.uniform()})) {
                points.push_back(s->p);
                points.push_back(s->p + s->ng * 1e-7f);
            }
        for (Vec3 from : points)
            for (const Vec2 u : {Vec2{0, 0}, Vec2{kOneMinusEpsilon, kOneMinusEpsilon}, Vec2{0, kOneMinusEpsilon},
                                 Vec2{kOneMinusEpsilon, 0}, Vec2{random.uniform(), random.uniform()}}) {
                const auto s = c.shape->sampling()->sample(from, 0, u);
                if (!s) continue;
                INFO(c.name << " from " << from.x << " " << from.y << " " << from.z);
                REQUIRE(isFinite(s->p));
                REQUIRE(isFinite(s->pError));
                REQUIRE(std::isfinite(s->pdfSolidAngle));
                REQUIRE(s->pdfSolidAngle > 0);
                REQUIRE(length(s->ng) == doctest::Approx(1).epsilon(1e-4));
            }
    }
}
