#include "lights/daylight_light.h"
#include "lights/environment_light.h"
#include "lights/sky_light.h"
#include "lights/window_light.h"
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
        const std::array<Vec3d, 4> second{Vec3d{0.5, 0, 2}, {0.5, 3, 2}, {2, 3, 2}, {2, 0, 2}};
        const std::array<Vec3d, 4> behind{Vec3d{0, 0, -5}, {0, 1, -5}, {1, 1, -5}, {1, 0, -5}};
        const WindowLight light(std::make_unique<EnvironmentLight>(std::move(image), std::make_unique<Grey>(), 1,
                                                                   Transform::rotate({1, 2, 3}, 0.9 * turn), true),
                                {kWindow, second, behind});
        test::Random random(11);
        test::Moments through;
        int wrong = 0; // rounded over the edge of a cell
        for (int i = 0; i < 20000; ++i) {
            const auto s =
                light.sample(Vec3{0, 0.5f, 0}, 0, {random.uniform(), random.uniform()}, Wavelengths::single(550), 0);
            REQUIRE(s);
            wrong += std::abs(light.pdfEscaped(Vec3{0, 0.5f, 0}, s->wi, 0) / s->pdfSolidAngle - 1) > 2e-3f;
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
        CHECK(wrong < 20);
        CHECK(std::abs(through.mean() - expected) < 4.5 * through.standardError() + 2e-3 * expected);
    }
}

// Of any light: all of it that windows show is sampled, and outdoors it is what it was.
TEST_CASE("sky and daylight through two windows: samples carry what is seen through them") {
    const ConstantCurve albedo(0.3), even(2);
    const auto sky = [&]() -> std::unique_ptr<DistantLight> {
        return std::make_unique<SkyLight>(ScaledCurve{&even, 1});
    };
    const auto daylight = [&]() -> std::unique_ptr<DistantLight> {
        return std::make_unique<DaylightSky>(Frame::fromNormalTangent({0, 1, 0}, {0, 0, 1}), 0.5, AirParams{3, 300},
                                             albedo, true);
    };
    const Receiver receivers[] = {Vec3{0, 0.5f, 0}, Receiver({0, 0.5f, 0}, {0, 0, 1}, false),
                                  Receiver({0.5f, -1, 0.5f}, {0, 1, 0}, false),
                                  Receiver({0.5f, -1, 0.5f}, {0, -1, 0}, true)};
    const std::array<Vec3d, 4> high{Vec3d{1.5, 2, 2}, {1.5, 3, 2}, {2, 3, 2}, {2, 2, 2}};
    const Wavelengths lambda = Wavelengths::single(550);
    for (const auto& make : {std::function(sky), std::function(daylight)}) {
        const WindowLight light(make(), {kWindow, high});
        for (const Receiver& at : receivers) {
            test::Random random(5);
            test::Moments through;
            for (int i = 0; i < 20000; ++i) {
                const auto s = light.sample(at, 0, {random.uniform(), random.uniform()}, lambda, 0);
                REQUIRE(s);
                CHECK(light.pdfEscaped(at, s->wi, 0) == doctest::Approx(s->pdfSolidAngle).epsilon(2e-3));
                through.add(s->radiance[0] / s->pdfSolidAngle);
            }
            double expected = 0;
            constexpr int n = 800;
            const std::pair<Vec3d, Vec3d> areas[] = {{{-1, 0, 2}, {2, 1.5, 0}}, {high[0], {0.5, 1, 0}}};
            for (const auto& [from, size] : areas)
                for (int i = 0; i < n * n; ++i) {
                    const Vec3d d =
                        from + Vec3d{size.x * (i / n + 0.5) / n, size.y * (i % n + 0.5) / n, 0} - Vec3d(at.p);
                    const double l = length(d);
                    expected += static_cast<double>(light.escaped(Vec3(d * (1 / l)), lambda, 0)[0]) * d.z /
                                (l * l * l) * size.x * size.y / (n * n);
                }
            CHECK(std::abs(through.mean() - expected) < 4.5 * through.standardError() + 2e-3 * expected);
            CHECK(std::sqrt(through.variance()) < 0.1 * through.mean());
        }
        const Receiver facesAway({0, 0.5f, 0}, {0, 0, -1}, false), outdoors({0, 0, 3}, {0, 1, 0}, false);
        CHECK_FALSE(light.sample(facesAway, 0, {0.5f, 0.5f}, lambda, 0));
        CHECK(light.pdfEscaped(facesAway, {0, 0, 1}, 0) == 0);
        const auto alone = make();
        const auto a = light.sample(outdoors, 0, {0.3f, 0.6f}, lambda, 0),
                   b = alone->sample(outdoors, 0, {0.3f, 0.6f}, lambda, 0);
        REQUIRE(a);
        CHECK(a->wi == b->wi);
        CHECK(light.pdfEscaped(outdoors, b->wi, 0) == b->pdfSolidAngle);
        CHECK(light.inSight(outdoors) == 1);
        CHECK(light.inSight(receivers[0]) < 0.5f);
        CHECK(light.inSight(Receiver(Vec3{0, 0, -2000})) == kBesidePortals);
    }
}

TEST_CASE("a sun is in sight where a surface faces it and a window shows it") {
    const ConstantCurve even(1);
    const Portals windows({kWindow}, bright);
    SunLight sun({0, 0.6, 0.8}, 0.005, {&even, 1});
    CHECK(sun.inSight(Vec3{0, 0, 0}) == 1);
    CHECK(sun.inSight(Receiver({0, 0, 0}, {0, 1, 0}, false)) == doctest::Approx(0.6).epsilon(0.02));
    CHECK(sun.inSight(Receiver({0, 0, 0}, {0, -1, 0}, false)) == 0);
    CHECK(sun.inSight(Receiver({0, 0, 0}, {0, -1, 0}, true)) == 1);
    CHECK(sun.inSight(Receiver({0, 0, 0}, {0, 0.8f, -0.6f}, false)) > 0); // its edge rises above the surface
    sun.lookThrough(windows);
    CHECK(sun.inSight(Vec3{0, 0, 1}) == 1);                 // passes at a height of 0.75
    CHECK(sun.inSight(Vec3{0, 0.1f, 0}) == kBesidePortals); // above the window
    CHECK(sun.inSight(Vec3{1.1f, 0, 1}) == kBesidePortals); // beside it
    CHECK(sun.inSight(Vec3{0, 0, 2.5f}) == 1);              // outdoors
}

} // namespace abbe
