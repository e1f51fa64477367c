// The computed sky against published measurements of clear skies.
#include "lights/amount.h"
#include "lights/clear_sky.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"

#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <utility>

namespace abbe {
namespace {

constexpr double kArcDegree = kPiD / 180;

// Luminance of the spectra that values at the bands stand for, or illuminance.
double photometric(const SkyBands& value) {
    return luminousIntegral(
        SampledCurve([&](double nm) { return solarIrradianceInSpace(nm) * ClearSky::scale(nm) * value.at(nm); }));
}

// Correlated colour temperature from 3000 K to 50 000 K [HernandezAndres1999].
double skyTemperature(const SkyBands& value) {
    const Chromaticity c = chromaticity(integrate(
        SampledCurve([&](double nm) { return solarIrradianceInSpace(nm) * ClearSky::scale(nm) * value.at(nm); })));
    const double n = (c.x - 0.3366) / (c.y - 0.1735);
    return -949.86315 + 6253.80338 * std::exp(-n / 0.92159) + 28.70599 * std::exp(-n / 0.20039) +
           0.00004 * std::exp(-n / 0.07125);
}

Vec3 skyDirection(double elevation, double azimuth) {
    return Vec3(
        Vec3d{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)});
}

// Irradiance of the ground by the sky alone.
SkyBands fromSky(const ClearSky& sky) {
    constexpr int rows = 96, columns = 96;
    SkyBands sum(0);
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const double z = (r + 0.5) / rows;
            sum = fma(sky.at(skyDirection(std::asin(z), (c + 0.5) / columns * kPiD)),
                      static_cast<float>(z * 2 * kPiD / (rows * columns)), sum);
        }
    return sum;
}

double sunIlluminance(double elevation, const AirParams& air) { // lx on a surface that faces it
    return luminousIntegral(solarIrradiance(kPiD / 2 - elevation * kArcDegree, air));
}

const SkyBands kGreyGround(0.2f);
// The turbidity of what the lighting engineers' tables call a clear day: their sunlight is that of this model.
constexpr AirParams kClearDay{1.9, 300};

} // namespace

TEST_CASE("the sun outside of the air has 133.3 klx") { // [Darula2005]
    CHECK(luminousIntegral(SampledCurve(solarIrradianceInSpace)) == doctest::Approx(133.3e3).epsilon(0.01));
}

// [IES1984]: 127.5 klx exp(-0.21 / sin h) from the sun, and 0.8 + 15.5 sqrt(sin h) klx from the sky.
TEST_CASE("a clear day has the illuminance of the lighting engineers' formulas") {
    for (const double elevation : {20., 30., 45., 60., 75.}) {
        const double sine = std::sin(elevation * kArcDegree);
        const ClearSky sky(kClearDay, elevation * kArcDegree, kGreyGround);
        const double sun = sunIlluminance(elevation, kClearDay), diffuse = photometric(fromSky(sky));
        MESSAGE(elevation << "°: sun " << sun << " lx, published " << 127.5e3 * std::exp(-0.21 / sine) << "; sky "
                          << diffuse << " lx, published " << 1e3 * (0.8 + 15.5 * std::sqrt(sine)));
        CHECK(sun == doctest::Approx(127.5e3 * std::exp(-0.21 / sine)).epsilon(0.05));
        CHECK(diffuse == doctest::Approx(1e3 * (0.8 + 15.5 * std::sqrt(sine))).epsilon(0.12));
    }
}

// log10 lx = l0 + l1 x + l2 x² + l3 x³, x = elevation / 90° [Janiczek1987]: means of many places, by day and twilight.
TEST_CASE("daylight and twilight have the illuminance that is measured") {
    struct Part {
        double from, l[4];
    };
    constexpr Part kParts[] = {{20, {3.74, 3.97, -4.07, 1.47}},
                               {5, {3.05, 13.28, -45.98, 64.33}},
                               {-0.8, {2.88, 22.26, -207.64, 1034.30}},
                               {-5, {2.88, 21.81, -258.11, -858.36}},
                               {-12, {2.70, 12.17, -431.69, -1899.83}}};
    for (const double elevation : {60., 40., 20., 10., 5., 0., -3., -6., -9., -12.}) {
        const Part* part = kParts;
        while (elevation < part->from) ++part;
        const double x = elevation / 90;
        const double published = std::pow(10, part->l[0] + x * (part->l[1] + x * (part->l[2] + x * part->l[3])));
        const ClearSky sky({2.5, 300}, elevation * kArcDegree, kGreyGround);
        const double sun = sunIlluminance(elevation, {2.5, 300}) * std::max(std::sin(elevation * kArcDegree), 0.0);
        const double global = photometric(fromSky(sky)) + sun;
        MESSAGE(elevation << "°: " << global << " lx, published " << published);
        CHECK(std::abs(std::log(global / published)) < std::log(1.35));
    }
}

// [Karayel1984] for a Linke turbidity of 2.75: kcd/m².
TEST_CASE("the zenith has the luminance that is measured") {
    for (const double elevation : {10., 20., 30., 45., 60.}) {
        const ClearSky sky(kClearDay, elevation * kArcDegree, kGreyGround);
        const double published = 1e3 * ((1.376 * 2.75 - 1.81) * std::tan(elevation * kArcDegree) + 0.38);
        const double zenith = photometric(sky.at({0, 0, 1}));
        MESSAGE(elevation << "°: zenith " << zenith << " cd/m², published " << published);
        CHECK(zenith == doctest::Approx(published).epsilon(0.2));
    }
}

// Standard sky 12, "CIE standard clear sky, low luminance turbidity" [CIES011]: luminance over that of the zenith.
TEST_CASE("luminance is distributed as in the CIE clear sky") {
    const auto standard = [](double zenithAngle, double fromTheSun) {
        const auto gradation = [](double z) { return 1 - std::exp(-0.32 / std::cos(z)); };
        const auto indicatrix = [](double g) {
            return 1 + 10 * (std::exp(-3 * g) - std::exp(-1.5 * kPiD)) + 0.45 * square(std::cos(g));
        };
        return gradation(zenithAngle) * indicatrix(fromTheSun);
    };
    for (const double elevation : {25., 45.}) {
        const ClearSky sky(kClearDay, elevation * kArcDegree, kGreyGround);
        const double zenith = photometric(sky.at({0, 0, 1}));
        const double there = standard(0, kPiD / 2 - elevation * kArcDegree);
        const Vec3 sun = skyDirection(elevation * kArcDegree, 0);
        double sum = 0;
        int count = 0;
        for (const double height : {10., 25., 45., 65.})
            for (const double azimuth : {30., 60., 90., 135., 180.}) {
                const Vec3 w = skyDirection(height * kArcDegree, azimuth * kArcDegree);
                const double angle = std::acos(static_cast<double>(dot(w, sun)));
                const double expected = standard(kPiD / 2 - height * kArcDegree, angle) / there;
                const double ratio = photometric(sky.at(w)) / zenith / expected;
                CAPTURE(elevation);
                CAPTURE(height);
                CAPTURE(azimuth);
                CHECK(std::abs(std::log(ratio)) < std::log(1.65));
                sum += square(std::log(ratio));
                ++count;
            }
        MESSAGE(elevation << "°: root mean square of the ratio's logarithm " << std::sqrt(sum / count));
        CHECK(std::sqrt(sum / count) < 0.3);
    }
}

// (-132.1 + 59.77 log10 L) per million kelvin for a clear sky of the luminance L [Chain1999]. Differences count in
// these units: far from the sun both go towards 0, and kelvins towards infinity.
TEST_CASE("the sky has the colour temperature that is measured at its luminance") {
    for (const double elevation : {20., 40., 60.}) {
        const ClearSky sky(kClearDay, elevation * kArcDegree, kGreyGround);
        double sum = 0;
        int count = 0;
        for (const double height : {30., 60., 90.})
            for (const double azimuth : {60., 120., 180.}) {
                const SkyBands value = sky.at(skyDirection(height * kArcDegree, azimuth * kArcDegree));
                const double published = -132.1 + 59.77 * std::log10(photometric(value));
                const double found = 1e6 / skyTemperature(value);
                CAPTURE(elevation);
                CAPTURE(height);
                CAPTURE(azimuth);
                CHECK(std::abs(found - published) < 50);
                sum += found - published;
                ++count;
            }
        const double zenith = skyTemperature(sky.at({0, 0, 1})), all = skyTemperature(fromSky(sky));
        MESSAGE(elevation << "°: " << sum / count << " per million kelvin off; zenith " << zenith << " K, all of it "
                          << all << " K");
        CHECK(std::abs(sum / count) < 35);
        CHECK(zenith > 10000);
        CHECK(zenith < 35000);
        CHECK(all > 8500);
        CHECK(all < 13000);
    }
}

// In the middle of each, where other sources have it.
TEST_CASE("optical depths are those of other sources") {
    for (const double nm : {400., 500., 600., 700.}) {
        const double um2 = square(nm / 1000); // [HansenTravis1974]
        const double air = 0.008569 / square(um2) * (1 + 0.0113 / um2 + 0.00013 / square(um2));
        CHECK(rayleighDepth(nm) == doctest::Approx(air).epsilon(0.006));
    }
    // [Iqbal1983]: 0.125 per cm at 600 nm, older by thirty years.
    CHECK(ozoneDepth(600, 1000) == doctest::Approx(0.125).epsilon(0.08));
    CHECK(aerosolDepth(1000, 2) == doctest::Approx(0.0463));
    CHECK(aerosolDepth(550, 1) < 0.001);
}

TEST_CASE("phase functions scatter what they are asked for") {
    double rayleigh = 0, aerosol = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
        const auto cosine = static_cast<float>(-1 + (i + 0.5) * 2 / n);
        rayleigh += static_cast<double>(rayleighPhase(cosine)) * 4 * kPiD / n;
        aerosol += static_cast<double>(aerosolPhase(cosine)) * 4 * kPiD / n;
    }
    CHECK(rayleigh == doctest::Approx(1).epsilon(1e-4));
    CHECK(aerosol == doctest::Approx(1).epsilon(1e-3));
}

// White ground gives the sky more light, ozone takes some of twilight's yellow.
TEST_CASE("ground and ozone change the sky as they should") {
    const double day = 40 * kArcDegree, dusk = -4 * kArcDegree;
    const double dark = photometric(fromSky(ClearSky(kClearDay, day, SkyBands(0.f))));
    const double snow = photometric(fromSky(ClearSky(kClearDay, day, SkyBands(0.8f))));
    CHECK(snow > 1.2 * dark);
    CHECK(snow < 2 * dark);
    const auto yellow = [](const ClearSky& sky) {
        const SkyBands zenith = sky.at({0, 0, 1});
        return zenith.at(600) / zenith.at(450);
    };
    CHECK(yellow({{2, 300}, dusk, kGreyGround}) < 0.8 * yellow({{2, 0}, dusk, kGreyGround}));
}

} // namespace abbe
