// The irradiance under a glass ball, scenes/check/ball-caustic.scene, at twenty places against quadrature.
#include "support/ball_caustic_profile.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// Of the scene's cameras; the same numbers as there.
struct View {
    const char* name;
    double from, to; // x of the ends of its twenty pixels
    double pixel() const { return (to - from) / 20; }
};
constexpr View kLine{"line", 0, 0.6}, kEdge{"edge", 0.6, 1.8};
constexpr double kReflectance = 1e-5;
constexpr double kQuadratureError = 5e-4; // relative; measured below

BallCausticScene sceneOf(double lampRadius) {
    BallCausticScene scene;
    scene.lampRadius = lampRadius;
    return scene;
}

// Light that meets the ball is found by paths that begin at lights. Without them camera paths happen to meet the lamp.
constexpr bool kLightPaths = false;

// Exact radiance of a view's pixels, from ways of the order `first` on.
std::vector<double> expected(const View& view, double lampRadius, double refined = 1,
                             int first = BallCaustic::kDirect) {
    const BallCaustic caustic(sceneOf(lampRadius), static_cast<int>(256 * refined), 1e-6 / refined, first);
    const double w = view.pixel();
    const BallCausticProfile profile(caustic, std::hypot(view.to, w / 2) + 1e-9, w / refined, 1e-4 / refined);
    std::vector<double> radiance;
    for (int i = 0; i < 20; ++i) {
        const double x = view.from + w * i;
        const int cells = static_cast<int>(12 * refined);
        radiance.push_back(kReflectance / kPiD * profile.mean(x, x + w, -w / 2, w / 2, cells));
    }
    return radiance;
}

// Of a ray that may meet the ball, in vectors and without symmetry: what of a lamp of radiance 1 comes along it, with
// all its branches.
double followed(const BallCausticScene& s, Vec3d p, Vec3d d) {
    const Vec3d middle{0, s.ball, 0};
    const auto lampAlong = [&s](Vec3d from, Vec3d way) {
        if (way.y <= 0) return 0.0;
        const Vec3d at = from + way * ((s.lamp - from.y) / way.y);
        return at.x * at.x + at.z * at.z <= square(s.lampRadius) ? 1.0 : 0.0;
    };
    const auto reflected = [](Vec3d way, Vec3d n) { return way - n * (2 * dot(way, n)); };
    const Vec3d o = p - middle;
    const double half = dot(o, d), root = half * half - dot(o, o) + 1;
    if (root <= 0 || half > 0) return lampAlong(p, d);
    Vec3d at = p + d * (-half - std::sqrt(root)), n = at - middle;
    const double ci = -dot(d, n), ct = std::sqrt(1 - (1 - ci * ci) / square(s.index));
    const double rs = (ci - s.index * ct) / (ci + s.index * ct), rp = (s.index * ci - ct) / (s.index * ci + ct);
    const double r = (rs * rs + rp * rp) / 2;
    double sum = r * lampAlong(at, reflected(d, n)), inside = 1 - r;
    Vec3d way = d / s.index + n * (ci / s.index - ct);
    for (int i = 0; i < 200 && inside > 1e-9; ++i, inside *= r) {
        at = at + way * (-2 * dot(way, n));
        n = at - middle;
        // Outwards by Snell's law; the tangential part grows by the index.
        sum += inside * (1 - r) * lampAlong(at, (way - n * dot(way, n)) * s.index + n * ci);
        way = reflected(way, n);
    }
    return sum;
}

// `resolution`: of the standard errors of the first ten places, relative.
void compare(const View& view, double lampRadius, std::uint32_t samples, double resolution) {
    BuildOptions options;
    options.camera = view.name;
    const auto scene =
        TestScene::load("scenes/check/ball-caustic.scene", options, {fmt::format("lamp-radius={}", lampRadius)});
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    const TestImage image = render(scene, settings, {}, 32); // replicates: t of 7 degrees sees little at this level
    const auto exact = expected(view, lampRadius), byBall = expected(view, lampRadius, 1, BallCaustic::kReflected);
    std::string text;
    double widest = 0;
    for (std::size_t i = 0; i < 20; ++i) {
        const Estimate e = image.film.pixel(static_cast<int>(i), 0);
        double variance = e.variance;
        // A camera path that meets the lamp by the ball brings the floor's reflectance. Where few do, their spread says
        // less than Poisson's law.
        if (!kLightPaths) variance = std::max(variance, kReflectance * byBall[i] / samples);
        const double difference = e.mean / exact[i] - 1, error = std::sqrt(variance) / exact[i];
        INFO(std::string(view.name), " ", i, ": ", e.mean, " for ", exact[i], ", ", 100 * difference, " % ± ",
             100 * error, " %");
        const double beyond = std::max(0.0, std::abs(difference) - kQuadratureError);
        CHECK(studentTwoSided(beyond / error, e.degrees) > sidak(kImageLevel, 20));
        if (i < 10) widest = std::max(widest, error);
        text += fmt::format(" {:.2f}±{:.2f}", 100 * difference, 100 * error);
    }
    MESSAGE(std::string(view.name) << ", lamp of radius " << lampRadius << ", differences in %:" << text);
    CHECK(widest < resolution);
    CHECK(image.statistics.cappedPaths == 0);
}

} // namespace

TEST_CASE("quadrature under a ball: as brute force has it") {
    // A lattice of directions about the vertical line, even in solid angle times cosine; it sees the rim of the lamp to
    // about 1/√n of the hits' number.
    BallCausticScene s = sceneOf(0.5);
    const BallCaustic caustic(s);
    for (const double rho : {0.1, 0.4, 1.3, 1.7}) {
        const int rings = 800, spokes = 1600;
        double sum = 0;
        for (int i = 0; i < rings; ++i)
            for (int k = 0; k < spokes; ++k) {
                const double sin2 = (i + 0.5) / rings, phi = 2 * kPiD * (k + 0.5 + 0.618034 * i) / spokes;
                const double sine = std::sqrt(sin2);
                sum += followed(s, {rho, 0, 0}, {sine * std::cos(phi), std::sqrt(1 - sin2), sine * std::sin(phi)});
            }
        CHECK(caustic.irradiance(rho) == doctest::Approx(sum * kPiD / rings / spokes).epsilon(0.01));
    }
}

TEST_CASE("quadrature under a ball: light beside the ball alone is the form factor of a disk") {
    // [Howell2010, B-13], far enough out that the ball hides nothing.
    const BallCausticScene s = sceneOf(0.5);
    for (const double a : {2.5, 4.0}) {
        const double sum = a * a + s.lamp * s.lamp + 0.25, h2 = s.lamp * s.lamp;
        const double exact = kPiD / 2 * (1 - (a * a + h2 - 0.25) / std::sqrt(sum * sum - a * a));
        CHECK(BallCaustic(s).part(BallCaustic::kDirect, a) == doctest::Approx(exact).epsilon(1e-6));
    }
}

TEST_CASE("quadrature under a ball: twice as fine is the same to 0.05 %") {
    for (const double lampRadius : {0.5, 0.1, 0.02}) {
        if (lampRadius < 0.5 && !nightly()) continue;
        const auto coarse = expected(kLine, lampRadius), fine = expected(kLine, lampRadius, 2);
        for (std::size_t i = 0; i < 20; ++i) {
            INFO("lamp of radius " << lampRadius << ", place " << i);
            CHECK(coarse[i] == doctest::Approx(fine[i]).epsilon(kQuadratureError));
        }
    }
}

TEST_CASE("irradiance at twenty places under a ball") {
    // By chance, 0.5 % at the ten brightest takes 4 million samples.
    compare(kLine, 0.5, nightly() ? 1u << 22 : 1u << 19, nightly() ? 0.005 : 0.015);
    compare(kEdge, 0.5, nightly() ? 1u << 20 : 1u << 17, 0.5);
    if (!kLightPaths) return;
    for (const double lampRadius : {0.1, 0.02}) compare(kLine, lampRadius, nightly() ? 1u << 20 : 1u << 17, 0.005);
}

} // namespace abbe::test
