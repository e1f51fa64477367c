#include "spectrum/wavelengths.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

// The density of wavelengths.h from its definition.
double density(double nm) {
    const double c = std::cosh(0.0072 * (nm - 538));
    return 0.0039398042 / (c * c);
}

// Its integral from 360 nm.
double cumulative(double nm) {
    const auto antiderivative = [](double l) { return 0.0039398042 / 0.0072 * std::tanh(0.0072 * (l - 538)); };
    return antiderivative(nm) - antiderivative(360);
}

} // namespace

TEST_CASE("the wavelength density integrates to one") {
    CHECK(cumulative(830) == doctest::Approx(1).epsilon(1e-6));
    double sum = 0; // midpoint rule, independent of the antiderivative
    for (int i = 0; i < 47000; ++i) sum += density(360 + (i + 0.5) * 0.01) * 0.01;
    CHECK(sum == doctest::Approx(1).epsilon(1e-6));
}

TEST_CASE("sampled wavelengths are the quantiles of their density, and carry it") {
    for (int i = 0; i < 8000; ++i) {
        const float u = (static_cast<float>(i) + 0.37f) / 8000;
        const Wavelengths w = Wavelengths::sample(u);
        for (int lane = 0; lane < kLanes; ++lane) {
            const double quantile = std::fmod(u + lane / 8.0, 1.0);
            REQUIRE(std::abs(cumulative(w.nm[lane]) - quantile) < 2e-6);
            REQUIRE(std::abs(w.pdf[lane] / density(w.nm[lane]) - 1) < 3e-5);
        }
    }
}

TEST_CASE("the density is the Jacobian of the mapping") {
    const float h = 1.f / 1024;
    for (float u = h; u < 0.125f - h; u += 1.f / 256) {
        const Wavelengths a = Wavelengths::sample(u - h), b = Wavelengths::sample(u + h), m = Wavelengths::sample(u);
        for (int lane = 0; lane < kLanes; ++lane) {
            const double slope = (static_cast<double>(b.nm[lane]) - a.nm[lane]) / (2 * static_cast<double>(h));
            // The second-order term of the difference is largest in the far red.
            REQUIRE(std::abs(slope * m.pdf[lane] - 1) < 4e-3);
        }
    }
}

TEST_CASE("wavelengths stay in range and point into the table for every u") {
    for (const float u : {0.f, 1e-30f, 0x1p-24f, 0.125f, 0.25f - 0x1p-26f, 0.5f, 0x1.fffffep-1f}) {
        const Wavelengths w = Wavelengths::sample(u);
        for (int lane = 0; lane < kLanes; ++lane) {
            CHECK(w.nm[lane] >= 360);
            CHECK(w.nm[lane] <= 830);
            CHECK(w.cell[lane] >= 0);
            CHECK(w.cell[lane] <= 469);
            CHECK(w.fraction[lane] >= 0);
            CHECK(w.fraction[lane] <= 1);
            CHECK(w.pdf[lane] > 1e-4f);
            CHECK(360 + static_cast<float>(w.cell[lane]) + w.fraction[lane] ==
                  doctest::Approx(w.nm[lane]).epsilon(1e-7));
        }
    }
}

TEST_CASE("a single wavelength fills every lane, and the hero can be kept") {
    const Wavelengths end = Wavelengths::single(830);
    CHECK(end.cell[0] == 469);
    CHECK(end.fraction[7] == 1);
    Wavelengths w = Wavelengths::sample(0.3f);
    const float hero = w.nm[0], pdf = w.pdf[0];
    w.keepHero();
    for (int lane = 0; lane < kLanes; ++lane) {
        CHECK(w.nm[lane] == hero);
        CHECK(w.pdf[lane] == pdf);
    }
}
