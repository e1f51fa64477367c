#include "spectrum/spectrum.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace abbe;

TEST_CASE("the vector exponential is accurate over its whole range") {
    double worst = 0;
    for (int i = 0; i <= 1750000; ++i) {
        const float x = -87 + static_cast<float>(i) * 1e-4f;
        const double exact = std::exp(static_cast<double>(x));
        worst = std::max(worst, std::abs(exp(Spectrum(x))[i % 8] - exact) / exact);
    }
    CHECK(worst < 2e-7);
    CHECK(exp(Spectrum(-100.f))[3] == 0);
    CHECK(exp(Spectrum(0.f))[5] == 1);
    CHECK(std::isfinite(exp(Spectrum(1000.f))[0]));
}

TEST_CASE("the vector logarithm is accurate for all normal numbers") {
    double worst = 0;
    for (float x = std::numeric_limits<float>::min(); x < 1e38f; x *= 1.00013f) {
        const double exact = std::log(static_cast<double>(x));
        const double error = std::abs(log(Spectrum(x))[0] - exact);
        worst = std::max(worst, error / std::max(1.0, std::abs(exact)));
    }
    CHECK(worst < 3e-7);
    worst = 0;
    for (float x = 0.5f; x < 2; x += 1e-6f)
        worst = std::max(worst, std::abs(log(Spectrum(x))[7] - std::log(static_cast<double>(x))));
    CHECK(worst < 3e-7);
    CHECK(log(Spectrum(1.f))[2] == 0);
}

TEST_CASE("reductions and predicates look at every lane") {
    for (int lane = 0; lane < kLanes; ++lane) {
        Spectrum s(1.f);
        s.v[lane] = 5;
        CHECK(sum(s) == 12);
        CHECK(mean(s) == 1.5f);
        CHECK(maxLane(s) == 5);
        Spectrum zero(0.f);
        CHECK_FALSE(anyNonZero(zero));
        zero.v[lane] = -1e-30f;
        CHECK(anyNonZero(zero));
        CHECK(allFinite(s));
        s.v[lane] = std::numeric_limits<float>::quiet_NaN();
        CHECK_FALSE(allFinite(s));
        s.v[lane] = -std::numeric_limits<float>::infinity();
        CHECK_FALSE(allFinite(s));
    }
}

TEST_CASE("select and fma work per lane") {
    const Spectrum a(Float8{0, 1, 2, 3, 4, 5, 6, 7});
    const Spectrum s = select(a.v < 4.f, fma(a, Spectrum(2.f), Spectrum(1.f)), -a);
    for (int i = 0; i < 8; ++i) CHECK(s[i] == (i < 4 ? 2 * static_cast<float>(i) + 1 : -static_cast<float>(i)));
}

using namespace abbe;

namespace {

// The density of Wavelengths from its definition.
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
