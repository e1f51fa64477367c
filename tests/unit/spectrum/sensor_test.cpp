#include "spectrum/color_space.h"
#include "spectrum/curve.h"
#include "spectrum/emission_curves.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"
#include "spectrum/xyz.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <string>

using namespace abbe;

namespace {

// The mean of toXyz over n stratified hero wavelengths. Odd n: the lanes' quantiles then differ from sample to sample.
Xyz stratified(const Curve& light, int n) {
    Xyz sum;
    for (int i = 0; i < n; ++i) {
        const Wavelengths w = Wavelengths::sample((static_cast<float>(i) + 0.5f) / static_cast<float>(n));
        sum += toXyz(light.at(w), w);
    }
    return sum * (1.0 / n);
}

void checkXy(const Xyz& c, double x, double y, double tolerance) {
    CHECK(std::abs(chromaticity(c).x - x) < tolerance);
    CHECK(std::abs(chromaticity(c).y - y) < tolerance);
}

} // namespace

TEST_CASE("matching functions have their published values") {
    const Wavelengths w = Wavelengths::single(555);
    CHECK(ybar(w)[0] == doctest::Approx(1.0).epsilon(1e-6));
    CHECK(xbar(w)[3] == doctest::Approx(0.5120501).epsilon(1e-6));
    CHECK(zbar(w)[5] == doctest::Approx(0.005749999).epsilon(1e-5));
    CHECK(xbar(Wavelengths::single(360))[0] == doctest::Approx(0.0001299));
    CHECK(xbar(Wavelengths::single(830))[0] == doctest::Approx(1.251141e-6));
    CHECK(ybar(Wavelengths::single(500.5f))[0] == doctest::Approx(0.5 * (0.323 + 0.3340625)).epsilon(2e-3));
}

TEST_CASE("constant radiance of one has Y = 1, and all three sums agree with the matching functions") {
    const Xyz e = integrate(ConstantCurve(1));
    CHECK(e.y == doctest::Approx(1).epsilon(1e-9));
    CHECK(kYIntegral == doctest::Approx(106.857).epsilon(1e-5));
    CHECK(e.x == doctest::Approx(106.865404 / kYIntegral).epsilon(1e-7));
    CHECK(e.z == doctest::Approx(106.891948 / kYIntegral).epsilon(1e-7));
}

TEST_CASE("the hero-wavelength estimate of white is white") {
    const Xyz estimate = stratified(ConstantCurve(1), 255), exact = integrate(ConstantCurve(1));
    CHECK(std::abs(estimate.x - 1) < 2e-4); // E is not exactly (1, 1, 1) in the tables
    CHECK(std::abs(estimate.y - 1) < 1e-4);
    CHECK(std::abs(estimate.z - 1) < 4e-4);
    CHECK(std::abs(estimate.x - exact.x) < 1e-4);
    CHECK(std::abs(estimate.y - exact.y) < 1e-4);
    CHECK(std::abs(estimate.z - exact.z) < 1e-4);
}

TEST_CASE("toXyz is the plain sum over lanes") {
    const Wavelengths w = Wavelengths::sample(0.71f);
    const Spectrum radiance(Float8{1, 0, 3, -2, 0.5f, 7, 4, 2});
    double sum[3] = {};
    for (int j = 0; j < kLanes; ++j) {
        const double f = radiance[j] / w.pdf[j] / 8 / kYIntegral;
        sum[0] += f * xbar(w)[j];
        sum[1] += f * ybar(w)[j];
        sum[2] += f * zbar(w)[j];
    }
    const Xyz c = toXyz(radiance, w);
    CHECK(c.x == doctest::Approx(sum[0]).epsilon(1e-6));
    CHECK(c.y == doctest::Approx(sum[1]).epsilon(1e-6));
    CHECK(c.z == doctest::Approx(sum[2]).epsilon(1e-6));
}

TEST_CASE("illuminants have their published chromaticities") {
    const auto xyz = [](const char* name) { return integrate(*illuminantCurve(*findIlluminant(name))); };
    checkXy(xyz("D65"), 0.31272, 0.32903, 5e-5);
    checkXy(xyz("d65"), 0.3127, 0.3290, 1e-4);
    checkXy(xyz("D50"), 0.34567, 0.35851, 1e-4);
    checkXy(xyz("D60"), 0.32163, 0.33774, 3e-4);
    checkXy(xyz("A"), 0.44758, 0.40745, 5e-5);
    checkXy(xyz("C"), 0.31006, 0.31616, 1e-4);
    checkXy(xyz("E"), 1.0 / 3, 1.0 / 3, 1e-4);
    checkXy(xyz("FL2"), 0.3721, 0.3751, 5e-4);
    checkXy(xyz("F11"), 0.3805, 0.3769, 5e-4);
    checkXy(xyz("LED-B3"), 0.3756, 0.3723, 5e-4);
}

TEST_CASE("the estimator and the integral agree for every illuminant, lines included") {
    for (const auto name : illuminantNames()) {
        CAPTURE(name);
        const auto light = illuminantCurve(*findIlluminant(name));
        const Xyz exact = integrate(*light), estimate = stratified(*light, 2047);
        CHECK(exact.y == doctest::Approx(1).epsilon(1e-6));
        CHECK(estimate.x == doctest::Approx(exact.x).epsilon(1e-4));
        CHECK(estimate.y == doctest::Approx(exact.y).epsilon(1e-4));
        CHECK(estimate.z == doctest::Approx(exact.z).epsilon(1e-4));
    }
}

TEST_CASE("black bodies obey Stefan, Boltzmann and Wien") {
    for (const double kelvin : {1000.0, 3200.0, 6500.0}) {
        double total = 0; // trapezoid rule in log λ
        const double step = 1e-3;
        for (double s = std::log(50.0); s < std::log(1e7); s += step)
            total += planckRadiance(std::exp(s), kelvin) * std::exp(s) * step;
        CHECK(kPiD * total == doctest::Approx(5.670374419e-8 * std::pow(kelvin, 4)).epsilon(1e-6));
        const double peak = 2.897771955e6 / kelvin;
        CHECK(planckRadiance(peak, kelvin) > planckRadiance(peak * 1.001, kelvin));
        CHECK(planckRadiance(peak, kelvin) > planckRadiance(peak * 0.999, kelvin));
    }
    CHECK(blackbodyCurve(5000)->at(500.0) == doctest::Approx(planckRadiance(500, 5000)).epsilon(1e-6));
    CHECK(std::isfinite(blackbodyCurve(1)->maximum()));
    checkXy(integrate(*blackbodyCurve(6500)), 0.3135, 0.3237, 2e-4);
    checkXy(integrate(*blackbodyCurve(2855.5)), 0.44758, 0.40745, 2e-4);
}

TEST_CASE("a spectral line has a total of one and its wavelength's colour") {
    for (const double nm : {360.0, 360.25, 589.3, 632.816, 829.9, 830.0}) {
        CAPTURE(nm);
        const auto line = lineCurve(nm);
        double total = 0;
        for (int i = 360; i < 830; ++i) total += 0.5 * (line->at(double(i)) + line->at(i + 1.0));
        CHECK(total == doctest::Approx(1).epsilon(1e-6));
    }
    const Xyz sodium = integrate(*lineCurve(589));
    const Wavelengths w = Wavelengths::single(589);
    CHECK(sodium.y * kYIntegral == doctest::Approx(ybar(w)[0]).epsilon(1e-3));
    CHECK(sodium.x * kYIntegral == doctest::Approx(xbar(w)[0]).epsilon(1e-3));
}

// Cameras in the place of the CIE observer.

using namespace abbe;

namespace {

template <typename Estimate> Xyz mean(const Estimate& estimate, int samples = 4096) {
    Xyz sum;
    for (int i = 0; i < samples; ++i)
        sum += estimate(Wavelengths::sample((static_cast<float>(i) + 0.5f) / static_cast<float>(samples)));
    return sum * (1.0 / samples);
}

double distance(const Xyz& a, const Xyz& b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

std::unique_ptr<const Curve> patch(int i) { return reflectanceCurve(*findMeasured("macbeth-" + std::to_string(i))); }
std::unique_ptr<const Curve> namedLight(const char* name) { return illuminantCurve(*findIlluminant(name)); }

// Colour differences of the 24 patches between a camera and the observer, both under `light`.
struct Differences {
    double mean = 0, most = 0;
};
Differences differences(const Sensor& sensor, const Curve& light) {
    Differences d;
    const Xyz white = integrate(light);
    for (int i = 1; i <= 24; ++i) {
        const auto p = patch(i);
        const SampledCurve seen([&](double nm) { return p->at(nm) * light.at(nm); });
        const double e = deltaE2000(toLab(sensor.integrate(seen), white), toLab(integrate(seen), white));
        d.mean += e / 24;
        d.most = std::max(d.most, e);
    }
    return d;
}

} // namespace

TEST_CASE("sensor: without a camera it is the observer, bit for bit") {
    const Sensor sensor;
    CHECK(sensor.isObserver());
    const auto light = namedLight("FL11");
    for (int i = 0; i < 1000; ++i) {
        const Wavelengths w = Wavelengths::sample((static_cast<float>(i) + 0.5f) / 1000);
        const Xyz a = sensor(light->at(w), w), b = toXyz(light->at(w), w);
        REQUIRE((a.x == b.x && a.y == b.y && a.z == b.z));
    }
    CHECK(distance(sensor.integrate(*light), integrate(*light)) < 1e-7);
}

TEST_CASE("sensor: every camera gives its light the observer's colour") {
    REQUIRE(sensorNames().size() == 3);
    const auto a = namedLight("A"), d65 = namedLight("D65"), e = namedLight("E");
    const auto kelvin = blackbodyCurve(5000);
    const double scale = 1 / integrate(*kelvin).y;
    const SampledCurve thermal([&](double nm) { return scale * kelvin->at(nm); });
    for (const std::string_view name : sensorNames())
        for (const Curve* light : {a.get(), d65.get(), e.get(), static_cast<const Curve*>(&thermal)}) {
            CAPTURE(name);
            const Sensor sensor(*findSensitivities(name), *light);
            CHECK(distance(sensor.integrate(*light), integrate(*light)) < 2e-6);
        }
}

TEST_CASE("sensor: paths tend to the integral, by plain sums over the published figures") {
    const auto light = namedLight("D65");
    const Sensor sensor(*findSensitivities("nikon-d850"), *light);
    for (const int i : {1, 13, 15, 18, 19}) {
        const auto p = patch(i);
        const SampledCurve seen([&](double nm) { return p->at(nm) * light->at(nm); });
        const Xyz paths = mean([&](const Wavelengths& w) { return sensor(seen.at(w), w); });
        CHECK(distance(paths, sensor.integrate(seen)) < 1e-4);
    }
}

TEST_CASE("sensor: the figures and the matrix, found again from seven bands") {
    // The matrix is unknown here: three bands determine it, it must give the colours of four others.
    const auto light = namedLight("D65");
    const CameraSensitivities& camera = *findSensitivities("canon-5d-mark-iv");
    const Sensor sensor(camera, *light);
    const auto signals = [&](double centre) { // of a band of 20 nm, by plain sums over the camera's figures
        Xyz s;
        for (double nm = centre - 20; nm < centre + 20; nm += 0.5) {
            const auto k = static_cast<std::size_t>((nm - 380) / 5);
            const double t = (nm - 380) / 5 - static_cast<double>(k), f = 0.5 * (1 - std::abs(nm - centre) / 20);
            const auto at = [&](std::size_t c) { return (1 - t) * camera.rgb[k][c] + t * camera.rgb[k + 1][c]; };
            s += Xyz{at(0), at(1), at(2)} * f;
        }
        return s;
    };
    const auto seen = [&](double centre) {
        return sensor.integrate(SampledCurve([&](double nm) { return std::max(0.0, 1 - std::abs(nm - centre) / 20); }));
    };
    const auto columns = [](const Xyz& a, const Xyz& b, const Xyz& c) {
        return Matrix3{{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}};
    };
    const Matrix3 m =
        columns(seen(450), seen(540), seen(610)) * columns(signals(450), signals(540), signals(610)).inverse();
    for (const double centre : {480.0, 500.0, 580.0, 640.0})
        CHECK(distance(m.apply<Xyz>(signals(centre)), seen(centre)) < 1e-3 * seen(centre).y + 1e-5);
}

TEST_CASE("sensor: cameras see surfaces nearly as the observer does") {
    // Cameras are no observers, but near enough on surfaces; and under another light than that of the fit they err
    // more.
    const auto d65 = namedLight("D65"), fl11 = namedLight("FL11");
    for (const std::string_view name : sensorNames()) {
        CAPTURE(name);
        const Sensor sensor(*findSensitivities(name), *d65);
        const Differences d = differences(sensor, *d65);
        CHECK(d.mean < 0.9); // CIEDE2000; measured 0.69 to 0.86
        CHECK(d.most < 3);
        CHECK(d.mean > 0.5); // it does something
        CHECK(differences(sensor, *fl11).mean > 2 * d.mean);
    }
    CHECK(findSensitivities("kodak") == nullptr);
}
