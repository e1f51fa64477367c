#include "lights/amount.h"
#include "lights/clear_sky.h"
#include "lights/daylight_light.h"
#include "lights/sun_light.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"
#include "support/chi_square.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

// Correlated colour temperature [McCamy1992].
double temperature(const Curve& curve) {
    const Chromaticity c = chromaticity(integrate(curve));
    const double n = (c.x - 0.3320) / (0.1858 - c.y);
    return ((449 * n + 3525) * n + 6823.3) * n + 5520.33;
}

DaylightSky clearSky(double elevation, double turbidity, double albedo = 0.2) {
    const ConstantCurve ground(albedo);
    return {Frame::fromNormalTangent({0, 1, 0}, {1, 0, 0}), elevation, {turbidity, 300}, ground, true};
}

// lx on a horizontal surface, from the sky alone.
double skyIlluminance(const DaylightSky& sky) {
    double sum = 0;
    constexpr int rows = 64, columns = 128;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const double y = (r + 0.5) / rows, s = std::sqrt(1 - y * y), phi = 2 * kPiD * (c + 0.5) / columns;
            const Vec3 w(Vec3d{s * std::cos(phi), y, s * std::sin(phi)});
            const SampledCurve radiance([&](double nm) {
                return static_cast<double>(sky.escaped(w, Wavelengths::single(static_cast<float>(nm)), 0)[0]);
            });
            sum += luminousIntegral(radiance) * y * 2 * kPiD / (rows * columns);
        }
    return sum;
}

} // namespace

TEST_CASE("sunlight: illuminance and colour temperature against the height of the sun") {
    const auto sun = [](double elevation) { return solarIrradiance((90 - elevation) * kDegree, {2.5, 300}); };
    const SampledCurve high = sun(70), low = sun(3), set = sun(0.5);
    MESSAGE("sun at 70°: " << luminousIntegral(high) << " lx, " << temperature(high)
                           << " K; at 3°: " << luminousIntegral(low) << " lx, " << temperature(low) << " K");
    CHECK(luminousIntegral(high) > 85e3);
    CHECK(luminousIntegral(high) < 115e3);
    CHECK(temperature(high) > 5000);
    CHECK(temperature(high) < 6000);
    CHECK(temperature(low) < 3000);
    CHECK(luminousIntegral(low) < 0.15 * luminousIntegral(high));
    CHECK(luminousIntegral(set) < luminousIntegral(low));
    CHECK(luminousIntegral(set) > 0);
    CHECK(relativeAirMass(0) == doctest::Approx(1).epsilon(1e-3));
    CHECK(relativeAirMass(60 * kDegree) == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("a clear day has 100 klx on the ground") {
    const double elevation = 60 * kDegree;
    const DaylightSky sky = clearSky(elevation, 2.5);
    const double diffuse = skyIlluminance(sky), direct = luminousIntegral(sky.sunlight()) * std::sin(elevation);
    MESSAGE("sky " << diffuse << " lx, sun " << direct << " lx");
    CHECK(diffuse + direct > 80e3);
    CHECK(diffuse + direct < 120e3);
    CHECK(diffuse > 15e3);
    CHECK(diffuse < 25e3);
    // The ground is an even reflector of both.
    const Wavelengths at = Wavelengths::single(555);
    const SampledCurve ground([&](double nm) {
        return static_cast<double>(sky.escaped({0, -1, 0}, Wavelengths::single(static_cast<float>(nm)), 0)[0]);
    });
    CHECK(luminousIntegral(ground) == doctest::Approx(0.2 * (diffuse + direct) / kPiD).epsilon(2e-3));
    CHECK(sky.escaped(normalize(Vec3{1, -0.01f, 0}), at, 0)[0] == sky.escaped({0, -1, 0}, at, 0)[0]);
}

// Written out again: irradiance in space, air as [HansenTravis1974] has it, ozone absorption in 1/cm as [Iqbal1983] has
// it.
TEST_CASE("sunlight at single wavelengths: the sun in space, and what the air takes") {
    const double zenithAngle = 50 * kDegree, turbidity = 2.5;
    const double m = 1 / (std::cos(zenithAngle) + 0.15 * std::pow(93.885 - 50, -1.253));
    const double beta = 0.04608 * turbidity - 0.04586;
    struct Line {
        double nm, sun, ozone, water; // W·m⁻²·nm⁻¹, 1/cm, 1/cm
    };
    const SampledCurve sun = solarIrradiance(zenithAngle, {turbidity, 300});
    for (const Line& line : {Line{405, 1.715, 0, 0},
                             {435, 1.709, 0.001, 0},
                             {550, 1.863, 0.085, 0},
                             {630, 1.665, 0.082, 0},
                             {685, 1.465, 0.014, 0},
                             {740, 1.283, 0.008, 0.061}}) {
        const double um2 = square(line.nm / 1000), w = line.water * 2 * m;
        const double air = 0.008569 / square(um2) * (1 + 0.0113 / um2 + 0.00013 / square(um2));
        const double depth =
            m * (air + beta * std::pow(um2, -0.65) + 0.3 * line.ozone) + 0.2385 * w / std::pow(1 + 20.07 * w, 0.45);
        CAPTURE(line.nm);
        CHECK(sun.at(line.nm) == doctest::Approx(line.sun * std::exp(-depth)).epsilon(6e-3));
    }
}

TEST_CASE("every direction of every sky is finite and not negative; the horizon has no hole") {
    for (const double elevation : {-12., 0., 0.5, 90.})
        for (const double turbidity : {1., 10.}) {
            const DaylightSky sky = clearSky(elevation * kDegree, turbidity);
            CHECK(sky.power() > 0);
            CHECK(std::isfinite(sky.power()));
            test::Random random(3);
            for (int i = 0; i < 200; ++i) {
                const auto s = sky.sample(Vec3{}, 0, {random.uniform(), random.uniform()},
                                          Wavelengths::sample(random.uniform()), 0);
                REQUIRE(s);
                CHECK(allFinite(s->radiance));
                for (int lane = 0; lane < kLanes; ++lane) CHECK(s->radiance[lane] >= 0);
                CHECK(s->pdfSolidAngle > 0);
                CHECK(sky.pdfEscaped(Vec3{}, s->wi, 0) > 0);
            }
        }
}

TEST_CASE("directions of the sky follow their density, and the density its luminance") {
    const DaylightSky sky = clearSky(25 * kDegree, 3, 0.5);
    constexpr int rows = 64, columns = 64;
    const int samples = test::chiSquareSamples();
    const Frame axes = Frame::fromNormalTangent({0, 1, 0}, {1, 0, 0});
    // From everywhere, on the ground, under a roof that leans.
    for (const Receiver& at :
         {Receiver(Vec3{}), Receiver({}, {0, 1, 0}, false), Receiver({}, normalize(Vec3{0.4f, -1, 0.2f}), false)}) {
        std::vector<double> observed(rows * columns), expected;
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < columns; ++c) {
                double sum = 0; // four by four cells of the table
                constexpr int n = 16;
                for (int i = 0; i < n * n; ++i) {
                    const double z = 2 * (r + (i / n + 0.5) / n) / rows - 1,
                                 phi = 2 * kPiD * (c + (i % n + 0.5) / n) / columns;
                    const double s = std::sqrt(1 - z * z);
                    const Vec3 w = axes.toWorld(Vec3(Vec3d{s * std::cos(phi), s * std::sin(phi), z}));
                    sum += sky.pdfEscaped(at, w, 0) / (n * n);
                }
                expected.push_back(sum * samples * 4 * kPiD / (rows * columns));
            }
        test::Random random(5);
        test::Moments weight;
        int otherwise = 0; // samples of another density than they are met with
        for (int i = 0; i < samples; ++i) {
            const auto s = sky.sample(at, 0, {random.uniform(), random.uniform()}, Wavelengths::single(555), 0);
            if (!s) continue; // along the surface
            otherwise += s->pdfSolidAngle != sky.pdfEscaped(at, s->wi, 0);
            const Vec3 local = axes.toLocal(s->wi);
            double turn = std::atan2(local.y, local.x) / (2 * kPiD);
            turn = turn < 0 ? turn + 1 : turn;
            const int r = std::clamp(static_cast<int>((local.z + 1) / 2 * rows), 0, rows - 1);
            ++observed[static_cast<std::size_t>(r * columns + std::min(static_cast<int>(turn * columns), columns - 1))];
            weight.add(s->radiance[0] / s->pdfSolidAngle);
        }
        CHECK(otherwise == 0);
        // Cells that the edge of the receiver's hemisphere cuts are known to one part in 256.
        for (double& e : expected) e += 1e-3;
        CHECK(test::chiSquareTest(observed, expected, 20).pValue > 1e-4);
        // Nearly proportional: what is left is the colour of the sky.
        if (!at.oneSided()) CHECK(std::sqrt(weight.variance()) < 0.15 * weight.mean());
    }
}

TEST_CASE("samples of the sky are not wasted below an opaque ground") {
    const DaylightSky sky = clearSky(40 * kDegree, 2.5);
    const auto moments = [&](const Receiver& at) {
        test::Random random(9);
        test::Moments m;
        for (int i = 0; i < 100000; ++i) {
            const auto s = sky.sample(at, 0, {random.uniform(), random.uniform()}, Wavelengths::single(555), 0);
            m.add(s ? s->radiance[0] * std::max(0.f, s->wi.y) / s->pdfSolidAngle : 0);
        }
        return m;
    };
    const test::Moments with = moments({{}, {0, 1, 0}, false}), without = moments(Vec3{});
    MESSAGE("variance " << with.variance() / without.variance());
    CHECK(with.mean() == doctest::Approx(without.mean()).epsilon(0.02));
    CHECK(with.variance() < 0.5 * without.variance());
}

TEST_CASE("the sun's disk shines above the horizon, and twilight ends") {
    DaylightParams params;
    LightContext context;
    for (const double elevation : {-12.5, -40.}) {
        params.elevation = elevation * kDegree;
        Diagnostics diagnostics;
        CHECK(makeDaylight(params, context, diagnostics).empty());
        CHECK(diagnostics.all().front().code == "E0750");
    }
    for (const double elevation : {0., 10.})
        for (const bool sun : {true, false}) {
            params.elevation = elevation * kDegree;
            params.sun = sun;
            Diagnostics diagnostics;
            CHECK(makeDaylight(params, context, diagnostics).size() == (sun && elevation > 0 ? 2 : 1));
            CHECK(diagnostics.all().empty());
        }
}

} // namespace abbe
