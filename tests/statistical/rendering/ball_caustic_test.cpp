// The irradiance under a glass ball, scenes/check/ball-caustic.scene, at twenty places against quadrature.
#include "support/ball_caustic_profile.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <array>
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

BallCausticScene sceneOf(double lightRadius) {
    BallCausticScene scene;
    scene.lightRadius = lightRadius;
    return scene;
}

// Exact radiance of a view's pixels.
std::vector<double> expected(const View& view, double lightRadius, double refined = 1) {
    const BallCaustic caustic(sceneOf(lightRadius), static_cast<int>(256 * refined), 1e-6 / refined);
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

// Of a ray that may meet the ball, in vectors and without symmetry: what of a light of radiance 1 comes along it, with
// all its branches.
double followed(const BallCausticScene& s, Vec3d p, Vec3d d) {
    const Vec3d middle{0, s.ball, 0};
    const auto lightAlong = [&s](Vec3d from, Vec3d way) {
        if (way.y <= 0) return 0.0;
        const Vec3d at = from + way * ((s.lightHeight - from.y) / way.y);
        return at.x * at.x + at.z * at.z <= square(s.lightRadius) ? 1.0 : 0.0;
    };
    const auto reflected = [](Vec3d way, Vec3d n) { return way - n * (2 * dot(way, n)); };
    const Vec3d o = p - middle;
    const double half = dot(o, d), root = half * half - dot(o, o) + 1;
    if (root <= 0 || half > 0) return lightAlong(p, d);
    Vec3d at = p + d * (-half - std::sqrt(root)), n = at - middle;
    const double ci = -dot(d, n), ct = std::sqrt(1 - (1 - ci * ci) / square(s.index));
    const double rs = (ci - s.index * ct) / (ci + s.index * ct), rp = (s.index * ci - ct) / (s.index * ci + ct);
    const double r = (rs * rs + rp * rp) / 2;
    double sum = r * lightAlong(at, reflected(d, n)), inside = 1 - r;
    Vec3d way = d / s.index + n * (ci / s.index - ct);
    for (int i = 0; i < 200 && inside > 1e-9; ++i, inside *= r) {
        at = at + way * (-2 * dot(way, n));
        n = at - middle;
        // Outwards by Snell's law; the tangential part grows by the index.
        sum += inside * (1 - r) * lightAlong(at, (way - n * dot(way, n)) * s.index + n * ci);
        way = reflected(way, n);
    }
    return sum;
}

TestScene load(const char* camera, double lightRadius, std::optional<Vec2i> size = {}) {
    BuildOptions options;
    options.camera = camera;
    options.size = size;
    return TestScene::load("scenes/check/ball-caustic.scene", options, {fmt::format("lamp-radius={}", lightRadius)});
}

// Estimates of as many places against the exact values; the largest of their relative standard errors.
double compare(const std::string& name, const std::vector<Estimate>& found, const std::vector<double>& exact) {
    std::string text;
    double widest = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double difference = found[i].mean / exact[i] - 1, error = std::sqrt(found[i].variance) / exact[i];
        INFO(name, ", place ", i, ": ", 100 * difference, " % ± ", 100 * error, " %");
        const double beyond = std::max(0.0, std::abs(difference) - kQuadratureError);
        CHECK(studentTwoSided(beyond / error, found[i].degrees) > sidak(kImageLevel, 20));
        widest = std::max(widest, error);
        text += fmt::format(" {:.2f}±{:.2f}", 100 * difference, 100 * error);
    }
    MESSAGE(name << ", differences in %:" << text);
    return widest;
}

TestImage rendered(const TestScene& scene, std::uint32_t samples) {
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    TestImage image = renderAsProgram(scene, settings, 32); // replicates: t of 7 degrees sees little at this level
    CHECK(image.statistics.cappedPaths == 0);
    return image;
}

// The pixels of a view.
void compareView(const View& view, double lightRadius, std::uint32_t samples) {
    const TestImage image = rendered(load(view.name, lightRadius), samples);
    std::vector<Estimate> found;
    for (int i = 0; i < 20; ++i) found.push_back(image.film.pixel(i, 0));
    compare(fmt::format("{}, lamp of radius {}", view.name, lightRadius), found, expected(view, lightRadius));
}

// As light falls alike on all sides of the axis, a place can be all pixels at about that distance from it: a ring of
// the picture, in which many more light paths end. `resolution`: of the relative standard errors, which must be less.
void compareRings(double lightRadius, std::uint32_t samples, double resolution) {
    constexpr int kPlaces = 20, kWide = 2 * kPlaces;
    const double w = kLine.to / kPlaces;
    const TestScene scene = load("rings", lightRadius, Vec2i{kWide, kWide});
    const TestImage image = rendered(scene, samples);
    CHECK(image.statistics.lightPaths > 0);
    const BallCausticProfile profile(BallCaustic(sceneOf(lightRadius)), 1.5 * kLine.to, w, 1e-4);
    std::vector<double> exact(kPlaces);
    std::vector<std::array<double, 32>> sums(kPlaces);
    for (int y = 0; y < kWide; ++y)
        for (int x = 0; x < kWide; ++x) {
            const double x0 = w * (x - kPlaces), z0 = w * (y - kPlaces);
            const auto place = static_cast<std::size_t>(std::hypot(x0 + w / 2, z0 + w / 2) / w);
            if (place >= exact.size()) continue;
            exact[place] += kReflectance / kPiD * profile.mean(x0, x0 + w, z0, z0 + w, 4);
            for (int r = 0; r < 32; ++r) sums[place][static_cast<std::size_t>(r)] += image.film.replicateMean(x, y, r);
        }
    std::vector<Estimate> found;
    for (const auto& replicates : sums) {
        Moments m;
        for (const double v : replicates) m.add(v);
        found.push_back({m.mean(), m.variance() / m.count(), m.count() - 1});
    }
    CHECK(compare(fmt::format("rings, lamp of radius {}", lightRadius), found, exact) < resolution);
}

} // namespace

TEST_CASE("quadrature under a ball: as brute force has it") {
    // A lattice of directions about the vertical line, even in solid angle times cosine; it sees the rim of the light
    // to about 1/√n of the hits' number.
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
        const double sum = a * a + s.lightHeight * s.lightHeight + 0.25, h2 = s.lightHeight * s.lightHeight;
        const double exact = kPiD / 2 * (1 - (a * a + h2 - 0.25) / std::sqrt(sum * sum - a * a));
        CHECK(BallCaustic(s).part(BallCaustic::kDirect, a) == doctest::Approx(exact).epsilon(1e-6));
    }
}

// Of the quadrature alone, which brute force checks by day.
TEST_CASE("quadrature under a ball: twice as fine is the same to 0.05 %" * doctest::skip(!nightly())) {
    for (const double lightRadius : {0.5, 0.1, 0.02}) {
        const auto coarse = expected(kLine, lightRadius), fine = expected(kLine, lightRadius, 2);
        for (std::size_t i = 0; i < 20; ++i) {
            INFO("light of radius " << lightRadius << ", place " << i);
            CHECK(coarse[i] == doctest::Approx(fine[i]).epsilon(kQuadratureError));
        }
    }
}

TEST_CASE("irradiance at twenty places under a ball") {
    compareView(kLine, 0.5, nightly() ? 1u << 19 : 1u << 14);
    if (nightly()) compareView(kEdge, 0.5, 1u << 19);
    // Nightly, two and a half standard errors of any place are 0.5 %; most are far less.
    for (const double lightRadius : {0.5, 0.1, 0.02})
        if (nightly() || lightRadius == 0.02)
            compareRings(lightRadius, nightly() ? 7u << 13 : 1u << 9, nightly() ? 0.002 : 0.06);
}

} // namespace abbe::test
