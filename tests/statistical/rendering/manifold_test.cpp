// Manifold sampling against quadrature of a ball's images of a light, and against paths that find the light by chance.
#include "support/manifold_cases.h"
#include "support/manifold_walk.h"
#include "support/sphere_images.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// Nightly 32 times as many as otherwise; resolutions are those of four times as many as otherwise.
int times(int n) { return nightly() ? 8 * n : n / 4; }
double within(double resolution) { return nightly() ? resolution : 2 * resolution; }

// Means agree within 3.5 standard errors, and the error tells something.
void checkSame(const Moments& a, double b, double errorB, double resolution) {
    const double error = std::hypot(a.standardError(), errorB);
    CHECK(std::abs(a.mean() - b) < 3.5 * error + 2e-4 * std::abs(b));
    CHECK(error < within(resolution) * std::abs(b));
}

// Manifold sampling, and paths that find the same light by chance.
void checkAgainstWalk(const ManifoldMean& m, const Moments& walked, double resolution) {
    MESSAGE(
        fmt::format("{:.5g} +- {:.2g} by chance, {:.5g} +- {:.2g} by manifolds; {} capped, share {:.2g}; {:.1f} trials",
                    walked.mean(), walked.standardError(), m.value.mean(), m.value.standardError(), m.counts.capped,
                    m.cappedShare(), static_cast<double>(m.counts.trials) / m.value.count()));
    checkSame(m.value, walked.mean(), walked.standardError(), resolution);
}

} // namespace

TEST_CASE("the images of a small light in a glass ball: refracted, reflected, reflected inside") {
    const SphereImages ball{
        .centre = {0, 1.6, 0}, .radius = 1, .index = 1.5, .lightCentre = {1.5, 7, 0}, .lightRadius = 0.1};
    const ManifoldCase test("shape sphere { center 0 1.6 0; radius 1; material dielectric { ior 1.5 } }\n"
                            "light disk { center 1.5 7 0; normal 0 -1 0; radius 0.1; radiance 1 }\n");
    struct Point {
        Vec3 p;
        const char* signature;
        double resolution;
    };
    // The middle of the caustic lies near x = -0.45; it is over where x is beyond about -1.
    const Point points[] = {
        {{-0.45f, 0, 0}, "TT", 0.05},      {{-0.43f, 0, 0.05f}, "TT", 0.03},  {{-0.5f, 0, 0.1f}, "TT", 0.05},
        {{-0.3f, 0, 0.2f}, "TT", 0.05},    {{-0.6f, 0, 0.3f}, "TT", 0.05},    {{-0.45f, 0.3f, 0}, "TT", 0.05},
        {{-0.2f, 0.2f, 0.3f}, "TT", 0.05}, {{3, 0, 0.5f}, "R", 0.03},         {{0.5f, 4, 1}, "R", 0.03},
        {{-3, 0, 0.3f}, "R", 0.03},        {{1.6f, 3.5f, 0.3f}, "TRT", 0.06}, {{2.5f, 4, 0}, "TRT", 0.06},
        {{1.2f, 5, 0.4f}, "TRT", 0.06},
    };
    std::map<std::string, std::pair<double, double>> pooled;
    for (const Point& c : points) {
        INFO(fmt::format("{} at {} {} {}", c.signature, c.p.x, c.p.y, c.p.z));
        const double expected = ball.integral(Vec3d(c.p), c.signature);
        const int estimates = times(*c.signature == 'R' ? 300'000 : c.signature[1] == 'R' ? 160'000 : 80'000);
        const ManifoldMean m = test.mean(c.p, c.signature, estimates);
        MESSAGE(fmt::format(
            "{} at {} {} {}: {:.5g}, sampled {:.5g} +- {:.2g}; {:.2f} trials, {:.2f} iterations, {:.1f} rays each",
            c.signature, c.p.x, c.p.y, c.p.z, expected, m.value.mean(), m.value.standardError(),
            static_cast<double>(m.counts.trials) / m.value.count(),
            static_cast<double>(m.counts.iterations) / m.value.count(),
            static_cast<double>(m.counts.rays) / m.value.count()));
        CHECK(expected > 0);
        CHECK(m.counts.capped == 0);
        checkSame(m.value, expected, 0, c.resolution);
        const double weight = square(expected / m.value.standardError());
        auto& [sum, weights] = pooled[c.signature];
        sum += weight * m.value.mean() / expected;
        weights += weight;
    }
    // All points of a kind together see a fault of two per cent, or four by day.
    for (const auto& [signature, sums] : pooled) {
        const double ratio = sums.first / sums.second, error = 1 / std::sqrt(sums.second);
        INFO(fmt::format("{}: {:.4f} +- {:.4f} of what is expected", signature, ratio, error));
        CHECK(error < within(0.0055));
        CHECK(std::abs(ratio - 1) < 3.5 * error);
    }
    const ManifoldMean dark = test.mean({2, 0, 2}, "TT", 2000);
    CHECK(dark.value.mean() == 0);
    CHECK(ball.integral({2, 0, 2}, "TT") == 0);
}

TEST_CASE("a light all around a ball of glass: each kind of chain carries what Fresnel gives it") {
    const ManifoldCase test("shape sphere { center 0 0 4; radius 1; material dielectric { ior 1.5 } }\n"
                            "light sphere { center 0 0 2; radius 40; two-sided on; radiance 1 }\n");
    constexpr double sine2 = 1.0 / 16; // of the cone that the ball fills
    const std::pair<const char*, int> chains[] = {{"R", 0}, {"TT", 0}, {"TRT", 1}};
    for (const auto& [signature, inside] : chains) {
        // Over s² = sin²θ of the cone: dω = π d(s²) / cos θ. The ray meets the ball at the angle asin(s / sin of cone).
        double expected = 0;
        constexpr int steps = 20000;
        for (int i = 0; i < steps; ++i) {
            const double x = (i + 0.5) / steps, cosine = std::sqrt(1 - x);
            const double f = dielectricReflectance(cosine, 1.5);
            const double share = *signature == 'R' ? f : square(1 - f) * (inside ? f : 1);
            expected += share * kPiD * sine2 / std::sqrt(1 - sine2 * x) / steps;
        }
        const ManifoldMean m = test.mean({0, 0, 0}, signature, times(150000));
        CAPTURE(signature);
        checkSame(m.value, expected, 0, 0.08);
    }
}

TEST_CASE("all that is covered, and nothing else: two casters, every chain of up to three interfaces") {
    const char* const scenes[] = {
        // ball and mirror
        "shape sphere { center 0 1.5 0; radius 1; material dielectric { ior 1.5; absorption 0.3 } }\n"
        "shape quad { size 4 4; transform { rotate y 90 deg; translate -2 1.5 0 }; material conductor { index metal Ag "
        "} }\n"
        "light sphere { center 2 4 0.5; radius 0.5; radiance 1 }\n",
        // a pane before a polished ball
        "shape sphere { center 0 1.5 0; radius 0.8; material conductor { index metal Au } }\n"
        "shape box { size 3 3 0.2; center 0 1.5 -1.4; material dielectric { ior 1.5 } }\n"
        "light sphere { center 2 3 -3; radius 0.5; radiance 1 }\n",
    };
    const Vec3 points[] = {{0.2f, 0, 0.3f}, {0.3f, 0.2f, -3}};
    for (int i = 0; i < 4; ++i) {
        CAPTURE(i);
        // All images of the light, or the smaller ones alone.
        ManifoldCase test(scenes[i % 2], i % 2 ? (i < 2 ? kInfinity : 0.05f) : (i < 2 ? kInfinity : 0.02f));
        REQUIRE(test.scene.report() == "");
        REQUIRE(test.sampler->plan().casters.size() == 2);
        test.learn(points[i % 2], 400);
        const Moments walked = walkTo(test, points[i % 2], times(6'000'000));
        const ManifoldMean m = test.all(points[i % 2], times(400'000));
        checkAgainstWalk(m, walked, 0.06);
    }
}

TEST_CASE("a smooth mesh: its interpolated normals are what refracts") {
    const ManifoldCase test("shape subdivision {\n"
                            "points -1 0.6 -1  1 0.6 -1  1 2.6 -1  -1 2.6 -1  -1 0.6 1  1 0.6 1  1 2.6 1  -1 2.6 1\n"
                            "faces { - 0 3 2 1; - 4 5 6 7; - 0 1 5 4; - 2 3 7 6; - 1 2 6 5; - 0 4 7 3 }\n"
                            "dicing 4; material dielectric { ior 1.5 } }\n"
                            "light sphere { center 1.5 7 0; radius 0.4; radiance 1 }\n",
                            0.2f);
    REQUIRE(test.scene.report() == "");
    for (const Vec3 p : {Vec3{-0.5f, 0, 0.1f}, Vec3{0.3f, 0, 0.8f}}) {
        const Moments walked = walkTo(test, p, times(2'000'000));
        const ManifoldMean m = test.all(p, times(200'000));
        checkAgainstWalk(m, walked, 0.1);
    }
}

TEST_CASE("a sun by way of a ball, and over water") {
    const std::string shapes[] = {"shape sphere { center 0 1.6 0; radius 1; material dielectric { ior 1.5 } }\n",
                                  "shape quad { size 9 9; transform { rotate x -90 deg; translate 0 1 0 }; material "
                                  "dielectric { ior 1.33 } }\n"};
    for (const std::string& shape : shapes) {
        CAPTURE(shape);
        ManifoldCase test(shape +
                          "light sun { elevation 60 deg; azimuth 20 deg; radiance 1; angular-diameter 6 deg }\n");
        REQUIRE(test.scene.report() == "");
        const Vec3 p{0.35f, 0, 0.25f};
        test.learn(p, 400);
        const Moments walked = walkTo(test, p, times(4'000'000));
        const ManifoldMean m = test.all(p, times(100'000));
        checkAgainstWalk(m, walked, 0.06);
    }
}

TEST_CASE("dispersion: the hero's own chains, over all wavelengths") {
    const ManifoldCase test("shape sphere { center 0 1.6 0; radius 1; material dielectric { ior glass SF11 } }\n"
                            "light sphere { center 1.5 5 0; radius 0.4; radiance blackbody 5000 K }\n");
    REQUIRE(test.scene.report() == "");
    const Moments walked = walkTo(test, {-0.5f, 0, 0.1f}, times(2'000'000), true);
    const ManifoldMean m = test.all({-0.5f, 0, 0.1f}, times(400'000), true);
    checkAgainstWalk(m, walked, 0.05);
}

TEST_CASE("case 72: caustics of a ball and of a ring of glass lose less than a thousandth to the cap, and are finite") {
    const ManifoldCase test("shape sphere { center 0 2 0; radius 0.5; material dielectric { ior 1.5 } }\n"
                            "shape torus { major-radius 1; minor-radius 0.3; transform { translate 0 0.6 0 }; material "
                            "dielectric { ior 1.5 } }\n"
                            "light sphere { center 1 6 0; radius 0.3; radiance 1 }\n");
    REQUIRE(test.scene.report() == "");
    const Vec3 points[] = {{0.1f, 0, 0}, {-0.6f, 0, 0.2f}, {-1.2f, 0, 0.1f}, {0.4f, 0, 1.6f}};
    for (const Vec3 p : points) {
        INFO(fmt::format("{} {} {}", p.x, p.y, p.z));
        const Moments walked = walkTo(test, p, times(2'000'000));
        const ManifoldMean m = test.all(p, times(300'000));
        CHECK(std::isfinite(m.value.mean()));
        CHECK(m.cappedShare() < 1e-3);
        checkAgainstWalk(m, walked, 0.15);
    }
}

} // namespace abbe::test
