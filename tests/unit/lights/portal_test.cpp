#include "lights/environment_light.h"
#include "lights/portal.h"
#include "spectrum/curve.h"
#include "support/chi_square.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

// Two by one and a half, two metres before the origin, seen from there.
const std::array<Vec3d, 4> kWindow{Vec3d{-1, 0, 2}, {-1, 1.5, 2}, {1, 1.5, 2}, {1, 0, 2}};

double bright(Vec3 w) {
    return 0.2 + std::max(0.f, w.x) + 20 * std::exp(-80 * lengthSquared(w - normalize(Vec3{0.3f, 0.2f, 1})));
}
const Vec3 kPlaces[] = {{0, 0.5f, 0}, {3, -1, 1.9f}, {-0.5f, 1, -8}, {0, 0.7f, 1.8f}, {40, 30, -50}};

} // namespace

// Hard numbers beside the sampler: the window cut into small areas.
TEST_CASE("portals: the light through a window, and how evenly its samples carry it") {
    const Portal portal(kWindow, bright);
    for (const Vec3 from : kPlaces) {
        const auto view = portal.view(from);
        REQUIRE(view);
        test::Random random(3);
        test::Moments weight, area;
        int wrong = 0;
        for (int i = 0; i < 100000; ++i) {
            const Portal::Sample s = portal.sample(*view, {random.uniform(), random.uniform()});
            CHECK(s.pdf > 0);
            weight.add(bright(s.w) / s.pdf);
            area.add(1 / s.pdf);
            wrong += std::abs(portal.pdf(*view, s.w) / s.pdf - 1) > 1e-3f;
        }
        double light = 0, solidAngle = 0;
        constexpr int n = 1000;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const Vec3d d = Vec3d{-1 + 2 * (i + 0.5) / n, 1.5 * (j + 0.5) / n, 2} - Vec3d(from);
                const double l = length(d), part = d.z / (l * l * l) * 3 / (n * n);
                light += bright(Vec3(d * (1 / l))) * part;
                solidAngle += part;
            }
        CHECK(wrong < 100); // rounded over the edge of a cell or of the window
        CHECK(std::abs(weight.mean() - light) < 4.5 * weight.standardError() + 2e-4 * light);
        CHECK(std::abs(area.mean() - solidAngle) < 4.5 * area.standardError() + 2e-4 * solidAngle);
        CHECK(std::sqrt(weight.variance()) < 0.1 * weight.mean());
    }
}

TEST_CASE("portals: directions follow their density: χ² over the two angles") {
    const Portal portal(kWindow, bright);
    for (const Vec3 from : {Vec3{0, 0.5f, 0}, Vec3{-0.5f, 1, -8}}) {
        const auto view = portal.view(from);
        constexpr int n = 24, inner = 32;
        const int samples = test::chiSquareSamples();
        std::vector<double> observed(n * n), expected;
        // Over the window: places on it, and the density per area that the one per solid angle makes there.
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                double sum = 0;
                for (int k = 0; k < inner * inner; ++k) {
                    const double s = (i + (k / inner + 0.5) / inner) / n, t = (j + (k % inner + 0.5) / inner) / n;
                    const Vec3d d = Vec3d{-1 + 2 * s, 1.5 * t, 2} - Vec3d(from);
                    const double l = length(d);
                    sum += portal.pdf(*view, Vec3(d * (1 / l))) * d.z / (l * l * l) * 3 / (n * n * inner * inner);
                }
                expected.push_back(sum * samples);
            }
        test::Random random(7);
        for (int i = 0; i < samples; ++i) {
            const Vec3 w = portal.sample(*view, {random.uniform(), random.uniform()}).w;
            const float t = (2 - from.z) / w.z;
            const int a = static_cast<int>((from.x + w.x * t + 1) / 2 * n),
                      b = static_cast<int>((from.y + w.y * t) / 1.5f * n);
            ++observed[static_cast<std::size_t>(std::clamp(a, 0, n - 1) * n + std::clamp(b, 0, n - 1))];
        }
        // Cells of the table cut those of the test, whose sums are then off by parts of 1e-3.
        CHECK(test::chiSquareTest(observed, expected).pValue > 1e-5);
    }
}

TEST_CASE("portals: nothing is seen from outside, and darkness has a density") {
    const Portal portal(kWindow, bright), dark(kWindow, [](Vec3) { return 0.0; });
    CHECK_FALSE(portal.view(Vec3{0, 0, 2.1f}));
    CHECK_FALSE(portal.view(Vec3{0, 0, 2}));
    const auto view = dark.view(Vec3{0, 0, 0});
    REQUIRE(view);
    const Portal::Sample s = dark.sample(*view, {0.3f, 0.9f});
    CHECK(s.pdf > 0);
    CHECK(portal.pdf(*portal.view(Vec3{0, 0, 0}), {0, -0.6f, 0.8f}) == 0);
    CHECK_FALSE(Portal::isRectangle({Vec3d{0, 0, 0}, {1, 0, 0}, {1.1, 1, 0}, {0, 1, 0}}));
    CHECK_FALSE(Portal::isRectangle({Vec3d{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}}));
}

namespace {

class Grey final : public RgbRadiance {
  public:
    Spectrum at(Vec3 rgb, const Wavelengths&) const noexcept override { return Spectrum(rgb.y); }
};

} // namespace

// Hard case 33: pole and seam can lie anywhere; and 34: 1e9 of a sun in one texel.
TEST_CASE("an environment through portals that overlap: samples carry what the densities say") {
    for (int turn = 0; turn < 7; ++turn) {
        EnvironmentImage image{64, 32, {}};
        for (int i = 0; i < 64 * 32; ++i)
            for (int c = 0; c < 3; ++c) image.rgb.push_back(i == 40 * 16 + 3 ? 1e9f : 1.f + static_cast<float>(i % 7));
        EnvironmentLight light(std::move(image), std::make_unique<Grey>(), 1, Transform::rotate({1, 2, 3}, 0.9 * turn),
                               true);
        std::vector<Portal> portals;
        const std::array<Vec3d, 4> second{Vec3d{0.5, 0, 2}, {0.5, 3, 2}, {2, 3, 2}, {2, 0, 2}};
        const std::array<Vec3d, 4> behind{Vec3d{0, 0, -5}, {0, 1, -5}, {1, 1, -5}, {1, 0, -5}};
        for (const auto& corners : {kWindow, second, behind})
            portals.emplace_back(corners, [&](Vec3 w) { return light.luminance(w); });
        light.lookThrough(std::move(portals));
        test::Random random(11);
        test::Moments through;
        for (int i = 0; i < 20000; ++i) {
            const auto s =
                light.sample(Vec3{0, 0.5f, 0}, 0, {random.uniform(), random.uniform()}, Wavelengths::single(550), 0);
            REQUIRE(s);
            CHECK(light.pdfEscaped(Vec3{0, 0.5f, 0}, s->wi, 0) == doctest::Approx(s->pdfSolidAngle).epsilon(2e-3));
            through.add(s->radiance[0] / s->pdfSolidAngle);
        }
        double expected = 0; // over the union of the two that are seen
        constexpr int n = 1500;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double x = -1 + 3 * (i + 0.5) / n, y = 3 * (j + 0.5) / n;
                if (!((x < 1 && y < 1.5) || x > 0.5)) continue;
                const Vec3d d = Vec3d{x, y, 2} - Vec3d{0, 0.5, 0};
                const double l = length(d);
                expected +=
                    light.escaped(Vec3(d * (1 / l)), Wavelengths::single(550), 0)[0] * d.z / (l * l * l) * 9 / (n * n);
            }
        CHECK(std::abs(through.mean() - expected) < 4.5 * through.standardError() + 2e-3 * expected);
    }
}

} // namespace abbe
