// Lights without shape: what they send to a point against closed forms and quadrature.
#include "lights/point_light.h"
#include "lights/sky_light.h"
#include "lights/spot_light.h"
#include "lights/sun_light.h"
#include "spectrum/curve.h"
#include "spectrum/sensor.h"
#include "support/quadrature.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

namespace abbe {
namespace {

using schema::Dimension;
using schema::Quantity;

constexpr double kLightsDegree = kPiD / 180;
const SampledCurve kLightsSpectrum([](double nm) { return 37 * std::exp((nm - 360) / 200); });

LightContext context() {
    LightContext c;
    c.defaultColor = &kLightsSpectrum;
    return c;
}

// lx (or cd/m², …): the luminous integral of what the light's quantity is at each wavelength.
template <typename F> double luminous(F&& spectrum) {
    return luminousIntegral(
        SampledCurve([&](double nm) { return spectrum(Wavelengths::single(static_cast<float>(nm)))[0]; }));
}

Vec3 direction(double theta, double phi) {
    return {static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
            static_cast<float>(std::sin(theta) * std::sin(phi))};
}

TEST_CASE("a point light follows the inverse square, and its transform") {
    PointLightParams p;
    p.position = {0, 1, 0};
    p.transform = Transform::translate({2, 0, 0});
    p.intensity = Quantity{90, Dimension::luminousIntensity, {}};
    Diagnostics diagnostics;
    const auto light = makePointLight(p, context(), diagnostics);
    REQUIRE(light);
    const auto sample = [&](Vec3 from) { return light->sample(from, 0, {}, Wavelengths::single(555), 0); };
    const auto s = sample({2, -2, 0});
    REQUIRE(s);
    CHECK(s->wi == Vec3{0, 1, 0});
    CHECK(s->distance == 3);
    CHECK(s->delta);
    CHECK(luminous([&](const Wavelengths& w) {
              return light->sample(Vec3{2, -2, 0}, 0, {}, w, 0)->radiance;
          }) == doctest::Approx(10).epsilon(1e-5));
    CHECK_FALSE(sample({2, 1, 0}).has_value()); // at the light
}

TEST_CASE("a spot arrives nowhere on a ray outside of its reach, which is not much too long") {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto vector = [&] { return Vec3{unit(random), unit(random), unit(random)}; };
    for (const double angle : {0.01, 1.0, 20.0, 70.0, 120.0}) {
        const SpotLight light({0.2f, 0.1f, 0}, normalize(Vec3{1, 2, 3}), 0, angle * kLightsDegree,
                              {&kLightsSpectrum, 1});
        int lit = 0, within = 0;
        for (int i = 0; i < 2000; ++i) {
            // Rays that come by near the cone, and some of its own directions.
            const Vec3 target = Vec3{0.2f, 0.1f, 0} + normalize(Vec3{1, 2, 3}) * (2 * unit(random));
            const Vec3 origin = vector() * 3.f;
            const Vec3 nudge = vector() * static_cast<float>(angle * kLightsDegree);
            const Ray ray{origin, i % 2 ? normalize(target - origin + nudge) : normalize(Vec3{1, 2, 3} + nudge)};
            const auto reach = light.reach(ray, 10);
            for (int k = 0; k < 200; ++k) {
                const float t = 10 * (static_cast<float>(k) + 0.5f) / 200;
                const bool arrives =
                    light.sample(origin + ray.direction * t, 0, {}, Wavelengths::single(500), 0).has_value();
                const bool inside = reach && t >= reach->tNear && t <= reach->tFar;
                lit += arrives;
                within += inside;
                REQUIRE((!arrives || inside));
            }
        }
        CHECK(lit > 0);
        if (angle > 0.5 && angle < 80) CHECK(within < 1.1 * lit);
    }
}

TEST_CASE("the power of a point light is what was asked for") {
    PointLightParams p;
    p.power = Quantity{60, Dimension::power, {}};
    Diagnostics diagnostics;
    CHECK(makePointLight(p, context(), diagnostics)->power() == doctest::Approx(60));
}

TEST_CASE("the solid angle of a spot is the integral of its falloff") {
    for (const auto& [inner, outer] :
         {std::pair{20.0, 30.0}, {0.0, 90.0}, {40.0, 40.0}, {100.0, 180.0}, {0.001, 0.002}}) {
        const SpotLight light({}, {0, 1, 0}, inner * kLightsDegree, outer * kLightsDegree, {&kLightsSpectrum, 1});
        const float at = Wavelengths::single(555).nm[0];
        const double onAxis = kLightsSpectrum.at(at);
        const auto falloff = [&](double theta) {
            const auto s = light.sample(direction(theta, 0.3), 0, {}, Wavelengths::single(at), 0);
            return s ? s->radiance[0] / onAxis : 0.0;
        };
        const auto part = [&](double a, double b) {
            return test::integrate([&](double t) { return falloff(t) * 2 * kPiD * std::sin(t); }, a, b, 200);
        };
        const double integral = part(0, inner * kLightsDegree) + part(inner * kLightsDegree, outer * kLightsDegree);
        CHECK(SpotLight::solidAngle(inner * kLightsDegree, outer * kLightsDegree) ==
              doctest::Approx(integral).epsilon(2e-4));
        if (outer < 180)
            CHECK_FALSE(light.sample(direction(1.001 * outer * kLightsDegree, 1), 0, {}, {}, 0).has_value());
    }
}

TEST_CASE("a spot aims at its look-at point, and states cd on its axis") {
    SpotLightParams p;
    p.position = {0, 3, 0};
    p.lookAt = Vec3d{0, 0, 0};
    p.angle = 40 * kLightsDegree;
    p.intensity = Quantity{900, Dimension::luminousIntensity, {}};
    Diagnostics diagnostics;
    const auto light = makeSpotLight(p, context(), diagnostics);
    REQUIRE(light);
    CHECK(luminous([&](const Wavelengths& w) { return light->sample(Vec3(), 0, {}, w, 0)->radiance; }) ==
          doctest::Approx(100).epsilon(1e-5));
    const auto lit = [&](double degrees) {
        return light->sample(Vec3{static_cast<float>(3 * std::tan(degrees * kLightsDegree)), 0, 0}, 0, {}, {}, 0)
            .has_value();
    };
    CHECK(lit(19.9));
    CHECK_FALSE(lit(20.1)); // `angle` is the full angle
    p.lookAt = p.position;
    CHECK(makeSpotLight(p, context(), diagnostics) == nullptr);
    p.lookAt.reset();
    p.innerAngle = 50 * kLightsDegree;
    CHECK(makeSpotLight(p, context(), diagnostics) == nullptr);
    REQUIRE(diagnostics.all().size() == 2);
    CHECK(diagnostics.all()[0].code == "E0344");
    CHECK(diagnostics.all()[1].code == "E0345");
}

// Irradiance of the disk by quadrature over escaped().
double sunIrradiance(const DistantLight& sun, double halfAngle) {
    return luminous([&](const Wavelengths& w) {
        const double e = test::integrate(
            [&](double t) { return 2 * kPiD * std::sin(t) * std::cos(t) * sun.escaped(direction(t, 0.4), w, 0)[0]; }, 0,
            halfAngle, 40);
        return Spectrum(static_cast<float>(e));
    });
}

TEST_CASE("the sun gives the irradiance that was stated, whatever its size") {
    for (const double degrees : {0.05, 0.53, 10.0, 120.0, 180.0}) {
        SunLightParams p;
        p.toward = Vec3d{0, -2, 0};
        p.angularDiameter = degrees * kLightsDegree;
        p.irradiance = Quantity{100000, Dimension::illuminance, {}};
        Diagnostics diagnostics;
        const auto sun = makeSunLight(p, context(), diagnostics);
        REQUIRE(sun);
        CHECK(sun->infinite());
        CHECK(sunIrradiance(*sun, 0.5 * p.angularDiameter) == doctest::Approx(100000).epsilon(1e-4));
    }
}

TEST_CASE("the sun's luminance and its irradiance agree") {
    SunLightParams p;
    p.toward = Vec3d{0, -1, 0};
    p.luminance = Quantity{1.6e9, Dimension::luminance, {}};
    Diagnostics diagnostics;
    const auto sun = makeSunLight(p, context(), diagnostics);
    REQUIRE(sun);
    CHECK(sunIrradiance(*sun, 0.265 * kLightsDegree) ==
          doctest::Approx(1.6e9 * kPiD * square(std::sin(0.265 * kLightsDegree))).epsilon(1e-4));
    p.angularDiameter = 0;
    CHECK(makeSunLight(p, context(), diagnostics) == nullptr);
    CHECK(diagnostics.all()[0].code == "E0347");
}

// Hard case 30.
TEST_CASE("the solid angle of small suns does not cancel") {
    for (const double half : {2e-5, 1e-4, 1e-3, 0.1, 1.0, kPiD / 2}) {
        const SunLight sun({0, 1, 0}, half, {&kLightsSpectrum, 1});
        const double exact = 4 * kPiD * square(std::sin(half / 2));
        CHECK(1 / sun.sample(Vec3(), 0, {0.5f, 0.5f}, {}, 0)->pdfSolidAngle == doctest::Approx(exact).epsilon(1e-6));
    }
}

TEST_CASE("sampled directions of the sun lie in its disk with its radiance") {
    const double half = 0.265 * kLightsDegree;
    const SunLight sun({1, 2, 3}, half, {&kLightsSpectrum, 1});
    const Wavelengths w = Wavelengths::sample(0.3f);
    test::Random random(4);
    Vec3d sum;
    for (int i = 0; i < 10000; ++i) {
        const auto s = sun.sample(Vec3(), 0, {random.uniform() * 0.999f, random.uniform()}, w, 0);
        REQUIRE(s);
        CHECK(sun.escaped(s->wi, w, 0)[3] == s->radiance[3]);
        CHECK(sun.pdfEscaped(Vec3{}, s->wi, 0) == s->pdfSolidAngle);
        sum += Vec3d(s->wi);
    }
    CHECK(length(normalize(sum) - normalize(Vec3d{1, 2, 3})) < 1e-4);
    CHECK(sun.pdfEscaped(Vec3{}, {0, 1, 0}, 0) == 0);
}

TEST_CASE("a sun without diameter is a direction") {
    SunLightParams p;
    p.elevation = 90 * kLightsDegree;
    p.angularDiameter = 0;
    p.irradiance = Quantity{5, Dimension::illuminance, {}};
    Diagnostics diagnostics;
    const auto sun = makeSunLight(p, context(), diagnostics);
    REQUIRE(sun);
    CHECK_FALSE(sun->infinite());
    CHECK(sun->sample(Vec3(), 0, {}, {}, 0)->delta);
    CHECK(luminous([&](const Wavelengths& w) { return sun->sample(Vec3(), 0, {}, w, 0)->radiance; }) ==
          doctest::Approx(5).epsilon(1e-5));
}

TEST_CASE("elevation and azimuth: clockwise from north, which is -z, or +y where z is up") {
    SunLightParams p;
    p.elevation = 30 * kLightsDegree;
    p.azimuth = 90 * kLightsDegree;
    p.angularDiameter = 0;
    Diagnostics diagnostics;
    const float c = std::sqrt(0.75f);
    const auto towards = [&](LightContext c0) {
        return makeSunLight(p, c0, diagnostics)->sample(Vec3(), 0, {}, {}, 0)->wi;
    };
    CHECK(length(towards(context()) - Vec3{c, 0.5f, 0}) < 1e-6f);
    LightContext zUp = context();
    zUp.zUp = true;
    CHECK(length(towards(zUp) - Vec3{c, 0, 0.5f}) < 1e-6f);
    p.azimuth = 0;
    CHECK(length(towards(context()) - Vec3{0, 0.5f, -c}) < 1e-6f);
    CHECK(length(towards(zUp) - Vec3{0, c, 0.5f}) < 1e-6f);
    p.toward = Vec3d{0, -1, 0};
    CHECK(makeSunLight(p, context(), diagnostics) == nullptr);
    CHECK(diagnostics.all().back().code == "E0346");
}

TEST_CASE("a sky of L gives an open surface π L") {
    SkyLightParams p;
    p.irradiance = Quantity{10000, Dimension::illuminance, {}};
    Diagnostics diagnostics;
    const auto sky = makeSkyLight(p, context(), diagnostics);
    REQUIRE(sky);
    CHECK(luminous([&](const Wavelengths& w) {
              return sky->escaped({0, 1, 0}, w, 0);
          }) == doctest::Approx(10000 / kPiD).epsilon(1e-5));
    const auto byDefault = makeSkyLight({}, context(), diagnostics);
    CHECK(luminous([&](const Wavelengths& w) {
              return byDefault->escaped({1, 0, 0}, w, 0);
          }) == doctest::Approx(kDefaultSkyLuminance).epsilon(1e-5));
}

TEST_CASE("distant lights send their power through the disk around the scene") {
    SkyLight sky({&kLightsSpectrum, 1});
    SunLight sun({0, 1, 0}, 0.01, {&kLightsSpectrum, 1});
    Bounds3 bounds;
    bounds.add(Vec3{-1, -2, -2});
    bounds.add(Vec3{1, 2, 2});
    sky.commit(bounds);
    sun.commit(bounds);
    CHECK(sky.power() == doctest::Approx(4 * kPiD * kPiD * 9 * radiantIntegral(kLightsSpectrum)));
    CHECK(sun.power() == doctest::Approx(kPiD * 9 * radiantIntegral(kLightsSpectrum)));
    sky.commit({});
    CHECK(sky.power() > 0); // planes alone
}

} // namespace
} // namespace abbe
