#include "lights/amount.h"
#include "lights/daylight_light.h"
#include "lights/solar_spectrum.h"
#include "lights/sun_light.h"
#include "spectrum/named_spectra.h"
#include "spectrum/observer.h"
#include "support/chi_square.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

constexpr double kDegree = kPiD / 180;

// Correlated colour temperature [McCamy1992].
double temperature(const Curve& curve) {
    const Chromaticity c = chromaticity(integrate(curve));
    const double n = (c.x - 0.3320) / (0.1858 - c.y);
    return ((449 * n + 3525) * n + 6823.3) * n + 5520.33;
}

DaylightSky clearSky(double elevation, double turbidity, double albedo = 0.2) {
    const ConstantCurve ground(albedo);
    const double zenithAngle = kPiD / 2 - elevation;
    const Frame axes = Frame::fromNormal({0, 1, 0});
    const Vec3 sun(Vec3d{std::cos(elevation), std::sin(elevation), 0});
    return {axes, sun, turbidity, ground, std::make_unique<SampledCurve>(solarIrradiance(zenithAngle, turbidity)),
            true};
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

TEST_CASE("the daylight basis makes illuminants D55, D65 and D75") {
    const DaylightBasis basis;
    const std::pair<const char*, Chromaticity> kIlluminants[] = {
        {"D55", {0.33243, 0.34744}}, {"D65", {0.31272, 0.32903}}, {"D75", {0.29902, 0.31485}}};
    for (const auto& [name, place] : kIlluminants) {
        const auto published = illuminantCurve(findIlluminant(name).value());
        const DaylightWeights m = daylightWeights(place);
        const auto made = [&](double nm) { return basis.s0.at(nm) + m.m1 * basis.s1.at(nm) + m.m2 * basis.s2.at(nm); };
        const double scale = made(560) / published->at(560.0);
        for (double nm = 370; nm <= 770; nm += 10)
            CHECK(made(nm) == doctest::Approx(published->at(nm) * scale).epsilon(0.015));
        const SampledCurve curve(made);
        const Chromaticity c = chromaticity(integrate(curve));
        CHECK(std::abs(c.x - place.x) < 3e-4);
        CHECK(std::abs(c.y - place.y) < 3e-4);
    }
}

TEST_CASE("sunlight: illuminance and colour temperature against the height of the sun") {
    const auto sun = [](double elevation) { return solarIrradiance((90 - elevation) * kDegree, 2.5); };
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
    CHECK(diffuse > 8e3);
    CHECK(diffuse < 30e3);
    // The ground shines as an even reflector of both.
    const Wavelengths at = Wavelengths::single(555);
    const SampledCurve ground([&](double nm) {
        return static_cast<double>(sky.escaped({0, -1, 0}, Wavelengths::single(static_cast<float>(nm)), 0)[0]);
    });
    CHECK(luminousIntegral(ground) == doctest::Approx(0.2 * (diffuse + direct) / kPiD).epsilon(2e-3));
    CHECK(sky.escaped(normalize(Vec3{1, -0.01f, 0}), at, 0)[0] == sky.escaped({0, -1, 0}, at, 0)[0]);
}

TEST_CASE("the zenith has the luminance and the colour of the formulas") {
    for (const double elevation : {5., 30., 60., 85.})
        for (const double turbidity : {2., 3., 6.}) {
            // Written out again from [Preetham1999, appendix A.2].
            const double t = turbidity, s = (90 - elevation) * kDegree;
            const double chi = (4. / 9 - t / 120) * (kPiD - 2 * s);
            const double expected = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);
            const DaylightSky sky = clearSky(elevation * kDegree, turbidity);
            const SampledCurve zenith([&](double nm) {
                return static_cast<double>(sky.escaped({0, 1, 0}, Wavelengths::single(static_cast<float>(nm)), 0)[0]);
            });
            CHECK(luminousIntegral(zenith) == doctest::Approx(expected).epsilon(2e-3));
            const Chromaticity c = chromaticity(integrate(zenith)), model = PreethamSky(s, t).zenith().chromaticity;
            CHECK(std::abs(c.x - model.x) < 2e-3);
            CHECK(std::abs(c.y - model.y) < 2e-3);
            CHECK(c.x < 0.34); // blue
        }
}

TEST_CASE("between zenith and horizon the sky is that of the formulas") {
    // [Preetham1999, appendix A.2], written out again for turbidity 3.
    struct Perez {
        double a, b, c, d, e;
        double at(double theta, double gamma) const {
            return (1 + a * std::exp(b / std::cos(theta))) *
                   (1 + c * std::exp(d * gamma) + e * std::cos(gamma) * std::cos(gamma));
        }
    };
    const Perez luminance{-0.9269, -0.6387, 5.2570, -2.2153, 0.1693};
    const Perez x{-0.3171, -0.1987, 0.2113, -1.0912, 0.0354}, y{-0.3109, -0.2758, 0.1865, -1.7860, 0.0202};
    for (const double elevation : {15., 50.}) {
        const double sunAngle = (90 - elevation) * kDegree;
        const DaylightSky sky = clearSky(elevation * kDegree, 3);
        const PreethamSky::Value zenith = PreethamSky(sunAngle, 3).zenith();
        for (const double theta : {20., 55., 80., 88.})
            for (const double phi : {0., 40., 110., 180.}) {
                const double t = theta * kDegree, p = phi * kDegree;
                const Vec3d w{std::sin(t) * std::cos(p), std::cos(t), std::sin(t) * std::sin(p)};
                const double gamma =
                    std::acos(w.x * std::cos(elevation * kDegree) + w.y * std::sin(elevation * kDegree));
                const SampledCurve seen([&](double nm) {
                    return static_cast<double>(sky.escaped(Vec3(w), Wavelengths::single(static_cast<float>(nm)), 0)[0]);
                });
                const auto expected = [&](const Perez& f, double there) {
                    return there * f.at(t, gamma) / f.at(0, sunAngle);
                };
                CAPTURE(theta);
                CAPTURE(phi);
                CHECK(luminousIntegral(seen) == doctest::Approx(expected(luminance, zenith.luminance)).epsilon(2e-3));
                const Chromaticity c = chromaticity(integrate(seen));
                CHECK(std::abs(c.x - expected(x, zenith.chromaticity.x)) < 1.5e-3);
                CHECK(std::abs(c.y - expected(y, zenith.chromaticity.y)) < 1.5e-3);
            }
    }
}

TEST_CASE("sunlight at single wavelengths: extraterrestrial radiance, solid angle, and what the air takes") {
    const double zenithAngle = 50 * kDegree, turbidity = 2.5;
    const double m = 1 / (std::cos(zenithAngle) + 0.15 * std::pow(93.885 - 50, -1.253));
    const double beta = 0.04608 * turbidity - 0.04586;
    const double solidAngle = kPiD * square(std::sin(0.2666 * kDegree));
    struct Line {
        double nm, radiance, ozone, water; // W·cm⁻²·μm⁻¹·sr⁻¹, 1/cm, 1/cm
    };
    const SampledCurve sun = solarIrradiance(zenithAngle, turbidity);
    for (const Line& line : {Line{400, 2112.75, 0, 0},
                             {450, 2965.83, 0.003, 0},
                             {550, 2550.38, 0.085, 0},
                             {600, 2463.15, 0.125, 0},
                             {650, 2233.98, 0.028, 0},
                             {720, 1942.72, 0, 1}}) {
        const double um = line.nm / 1000, w = line.water * 2 * m;
        const double depth = m * (0.008735 * std::pow(um, -4.08) + beta * std::pow(um, -1.3) + 0.35 * line.ozone) +
                             0.2385 * w / std::pow(1 + 20.07 * w, 0.45);
        CAPTURE(line.nm);
        CHECK(sun.at(line.nm) == doctest::Approx(10 * line.radiance * solidAngle * std::exp(-depth)).epsilon(2e-3));
    }
}

TEST_CASE("every direction of every sky is finite and not negative; the horizon has no hole") {
    for (const double elevation : {0.01, 0.5, 3., 20., 45., 89.99, 90.})
        for (const double turbidity : {2., 3., 6., 10.}) {
            const DaylightSky sky = clearSky(elevation * kDegree, turbidity);
            CHECK(sky.power() > 0);
            CHECK(std::isfinite(sky.power()));
            test::Random random(3);
            for (int i = 0; i < 500; ++i) {
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
    const Frame axes = Frame::fromNormal({0, 1, 0});
    std::vector<double> observed(rows * columns), expected;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            double sum = 0; // four by four cells of the table
            for (int i = 0; i < 16; ++i) {
                const double z = 2 * (r + (i / 4 + 0.5) / 4) / rows - 1,
                             phi = 2 * kPiD * (c + (i % 4 + 0.5) / 4) / columns;
                const double s = std::sqrt(1 - z * z);
                const Vec3 w = axes.toWorld(Vec3(Vec3d{s * std::cos(phi), s * std::sin(phi), z}));
                sum += sky.pdfEscaped(Vec3{}, w, 0) / 16;
            }
            expected.push_back(sum * samples * 4 * kPiD / (rows * columns));
        }
    test::Random random(5);
    test::Moments weight;
    for (int i = 0; i < samples; ++i) {
        const auto s = sky.sample(Vec3{}, 0, {random.uniform(), random.uniform()}, Wavelengths::single(555), 0);
        const Vec3 local = axes.toLocal(s->wi);
        double turn = std::atan2(local.y, local.x) / (2 * kPiD);
        turn = turn < 0 ? turn + 1 : turn;
        const int r = std::clamp(static_cast<int>((local.z + 1) / 2 * rows), 0, rows - 1);
        ++observed[static_cast<std::size_t>(r * columns + std::min(static_cast<int>(turn * columns), columns - 1))];
        weight.add(s->radiance[0] / s->pdfSolidAngle);
    }
    CHECK(test::chiSquareTest(observed, expected).pValue > 1e-4);
    // Nearly proportional: what is left is the colour of the sky.
    CHECK(std::sqrt(weight.variance()) < 0.15 * weight.mean());
}

TEST_CASE("a sun at or below the horizon is refused") {
    DaylightParams params;
    LightContext context;
    for (const double elevation : {0., -10.}) {
        params.elevation = elevation * kDegree;
        Diagnostics diagnostics;
        CHECK(makeDaylight(params, context, diagnostics).empty());
        CHECK(diagnostics.all().front().code == "E0750");
    }
    params.elevation = 10 * kDegree;
    for (const bool sun : {true, false}) {
        params.sun = sun;
        Diagnostics diagnostics;
        CHECK(makeDaylight(params, context, diagnostics).size() == (sun ? 2 : 1));
        CHECK(diagnostics.all().empty());
    }
}

} // namespace abbe
