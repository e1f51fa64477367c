// Light that a medium scatters once, against integrals along the eye's rays; and how often light is scattered at all.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr double kExtinction = 0.8, kAlbedo = 0.6;
constexpr double kFov = 16; // degrees; every ray of the film meets the ball

double henyeyGreenstein(double cosine, double g) {
    return (1 - g * g) / (4 * kPiD * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

// Radiance of a white wall that faces the light: what its units come to on the film. Times π and a squared distance it
// is the intensity of a point, times π the irradiance of a sun.
double wallRadiance(const std::string& light) {
    const TestImage image = render(TestScene::parse("scene 1\nfilm { size 2 2; filter box 0.5 }\n"
                                                    "camera { from 0 0 3; look-at 0 0 0; fov 0.01 deg }\n"
                                                    "shape quad { size 1 1; material diffuse { reflectance 1 } }\n" +
                                                    light),
                                   64);
    return image.film.image().mean;
}

// A ball of radius 1 m, the eye 4 m away; each pixel's mean over `perPixel`² places of `along(from, direction)`.
template <typename Along> void checkSingle(const std::string& light, double g, double resolution, const Along& along) {
    const TestImage image = render(
        TestScene::parse(fmt::format("scene 1\nfilm {{ size 8 8; filter box 0.5 }}\nrender {{ max-depth 1 }}\n"
                                     "camera {{ from 0 0 4; look-at 0 0 0; fov {} deg }}\n"
                                     "shape sphere {{ radius 1; material boundary; interior homogeneous {{ extinction "
                                     "{}; albedo {}; phase henyey-greenstein {} }} }}\n{}",
                                     kFov, kExtinction, kAlbedo, g, light)),
        nightly() ? 65536 : 8192);
    const double half = std::tan(kFov / 2 * kPiD / 180);
    constexpr int n = 6;
    const auto pixel = [&](int px, int py) {
        double sum = 0;
        for (int i = 0; i < n * n; ++i) {
            const double x = ((px + (i % n + 0.5) / n) / 4 - 1) * half, y = (1 - (py + (i / n + 0.5) / n) / 4) * half;
            sum += along(Vec3d{0, 0, 4}, normalize(Vec3d{x, y, -1}));
        }
        return sum / (n * n);
    };
    checkSame(compareExpected(image.film, pixel, Channel::y, 2), resolution);
}

// Where a ray from outside enters and leaves the unit ball.
std::pair<double, double> chord(Vec3d from, Vec3d direction) {
    const double b = dot(from, direction), root = std::sqrt(b * b - lengthSquared(from) + 1);
    return {-b - root, -b + root};
}

} // namespace

TEST_CASE("single scattering of a sun by a ball of fog") {
    const std::string sun = "light sun { toward 1 -2 -1; angular-diameter 0 deg; irradiance 1 }\n";
    const Vec3d toward = normalize(Vec3d{1, -2, -1});
    const double irradiance = kPiD * wallRadiance("light sun { toward 0 0 -1; angular-diameter 0 deg; irradiance 1 }");
    REQUIRE(irradiance > 0);
    for (const double g : {0.0, 0.6, -0.6}) {
        INFO(g);
        checkSingle(sun, g, 0.004, [&](Vec3d from, Vec3d direction) {
            const auto [near, far] = chord(from, direction);
            const double scattered = irradiance * kAlbedo * kExtinction * henyeyGreenstein(dot(toward, -direction), g);
            constexpr int steps = 200;
            double sum = 0;
            for (int i = 0; i < steps; ++i) {
                const double t = near + (far - near) * (i + 0.5) / steps;
                const double in = chord(from + direction * t, -toward).second;
                sum += std::exp(-kExtinction * (t - near + in)) * (far - near) / steps;
            }
            return scattered * sum;
        });
    }
}

TEST_CASE("single scattering of a light inside a ball of fog") {
    const Vec3d emitter{0.1, 0.8, -0.1};
    const std::string light = "light point { position 0.1 0.8 -0.1; power 10 }\n";
    const double intensity = kPiD * wallRadiance("light point { position 0 0 1; power 10 }");
    REQUIRE(intensity > 0);
    for (const double g : {0.0, 0.6}) {
        INFO(g);
        checkSingle(light, g, 0.008, [&](Vec3d from, Vec3d direction) {
            const auto [near, far] = chord(from, direction);
            // Over the angle at the light, which takes the peak away.
            const double closest = dot(emitter - from, direction);
            const double d = length(from + direction * closest - emitter);
            const double a = std::atan((near - closest) / d), b = std::atan((far - closest) / d);
            constexpr int steps = 400;
            double sum = 0;
            for (int i = 0; i < steps; ++i) {
                const double t = closest + d * std::tan(a + (b - a) * (i + 0.5) / steps);
                const Vec3d in = from + direction * t - emitter;
                sum += std::exp(-kExtinction * (t - near + length(in))) *
                       henyeyGreenstein(dot(in, -direction) / length(in), g) * (b - a) / steps / d;
            }
            return intensity * kAlbedo * kExtinction * sum;
        });
    }
}

// In a body of any shape that scatters without loss, light from all around is scattered 4 V σ / S times on average,
// however and wherever it is scattered: the mean path inside is that of straight lines [Blanco2003]. Of a ball 4/3 σ R.
TEST_CASE("light is scattered as often in a ball as there are mean free paths in a mean chord") {
    for (const double g : {-0.5, 0.0, 0.8}) {
        INFO(g);
        TestScene scene = TestScene::parse(
            fmt::format("scene 1\nfilm {{ size 16 16; filter box 0.5 }}\nlight sky {{ radiance 1 }}\n"
                        "camera orthographic {{ from 0 0 4; look-at 0 0 0; height 2 }}\n"
                        "shape sphere {{ radius 1; material boundary; interior homogeneous {{ extinction 8 per-m; "
                        "albedo 1; phase henyey-greenstein {} }} }}\n",
                        g));
        RenderSettings settings = scene.settings();
        settings.samples = 2048;
        settings.technique.strategy = Technique::Strategy::bsdfOnly;
        const TestImage image = render(scene, settings);
        const double paths = static_cast<double>(image.statistics.paths);
        const double scattered = (static_cast<double>(image.statistics.vertices) / paths - 1) / (kPiD / 4);
        // Half a million paths through the ball, whose numbers spread by about 1.3 of their mean; and roulette ends
        // some of the paths beyond the 64th vertex, some thousandths.
        CHECK(scattered == doctest::Approx(8 * 4 / 3.).epsilon(0.01));
    }
}

TEST_CASE("a dense ball of albedo 0.99995 loses what its mean chord says, without a limit of depth") {
    // 1 - E ω^N with a mean N of 4/3 σ R; second order: half of (1 - ω)² N², N spread like an exponential at least.
    const double radius = nightly() ? 100 : 40; // in mean free paths
    TestScene scene = TestScene::parse(
        fmt::format("scene 1\nfilm {{ size 16 16; filter box 0.5 }}\nlight sky {{ radiance 1 }}\n"
                    "camera orthographic {{ from 0 0 4; look-at 0 0 0; height 2 }}\n"
                    "shape sphere {{ radius 1; material boundary; interior homogeneous {{ extinction {} per-m; albedo "
                    "0.99995 }} }}\n",
                    radius));
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? 4096 : 2048;
    settings.technique.strategy = Technique::Strategy::bsdfOnly;
    const TestImage image = render(scene, settings);
    CHECK(image.statistics.cappedPaths == 0);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    const double meanPath =
        static_cast<double>(image.statistics.vertices) / static_cast<double>(image.statistics.paths);
    // Without roulette, which ends one path in a thousand at every vertex from the 64th on, it would be π/3 σ R.
    CHECK(meanPath > 0.5 * radius);
    const double lost = 5e-5 * 4 / 3 * radius * kPiD / 4;
    const Estimate found = image.film.image();
    const double error = std::sqrt(found.variance);
    INFO(found.mean << " ± " << error << ", lost " << lost << ", vertices of a path " << meanPath);
    CHECK(error < 0.25 * lost);
    CHECK(std::abs(1 - found.mean - lost) < 4 * error + lost * lost);
}

} // namespace abbe::test
