// Cameras in the place of the CIE observer.
#include "spectrum/emission_curves.h"
#include "spectrum/lab.h"
#include "spectrum/matrix3.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sampled_curve.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <string>

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
std::unique_ptr<const Curve> lamp(const char* name) { return illuminantCurve(*findIlluminant(name)); }

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
    const auto light = lamp("FL11");
    for (int i = 0; i < 1000; ++i) {
        const Wavelengths w = Wavelengths::sample((static_cast<float>(i) + 0.5f) / 1000);
        const Xyz a = sensor(light->at(w), w), b = toXyz(light->at(w), w);
        REQUIRE((a.x == b.x && a.y == b.y && a.z == b.z));
    }
    CHECK(distance(sensor.integrate(*light), integrate(*light)) < 1e-7);
}

TEST_CASE("sensor: every camera gives its light the observer's colour") {
    REQUIRE(sensorNames().size() == 3);
    const auto a = lamp("A"), d65 = lamp("D65"), e = lamp("E");
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
    const auto light = lamp("D65");
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
    const auto light = lamp("D65");
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
    const auto d65 = lamp("D65"), fl11 = lamp("FL11");
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
