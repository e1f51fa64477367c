#include "spectrum/spectrum.h"

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
