#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

// ∫ over [360, 830] of the reconstructed curve.
double integral(const Curve& c) {
    double sum = 0;
    for (int nm = 360; nm < 830; ++nm) sum += 0.5 * (c.at(static_cast<double>(nm)) + c.at(nm + 1.0));
    return sum;
}

} // namespace

TEST_CASE("a sampled curve is exact at its nodes and linear in between, in double and in eight lanes") {
    const SampledCurve c([](double nm) { return 3 + 0.25 * nm; });
    CHECK(c.at(360.0) == 93);
    CHECK(c.at(830.0) == 210.5);
    CHECK(c.at(500.5) == doctest::Approx(3 + 0.25 * 500.5).epsilon(1e-7));
    CHECK(c.at(100.0) == c.at(360.0));
    CHECK(c.at(2000.0) == c.at(830.0));
    CHECK(c.minimum() == 93);
    CHECK(c.maximum() == 210.5);
    CHECK_FALSE(c.isConstant());
    for (int i = 0; i < 1000; ++i) {
        const Wavelengths w = Wavelengths::sample(static_cast<float>(i) / 1000);
        const Spectrum s = c.at(w);
        for (int lane = 0; lane < kLanes; ++lane)
            REQUIRE(s[lane] == doctest::Approx(c.at(static_cast<double>(w.nm[lane]))).epsilon(3e-7));
    }
}

TEST_CASE("interpolated points are constant beyond both ends and 5 nm data are kept exactly") {
    const double nm[] = {400, 405, 410, 700}, v[] = {0.1, 0.6, 0.2, 0.9};
    const SampledCurve c = SampledCurve::fromPoints(nm, v);
    for (int i = 0; i < 4; ++i) CHECK(c.at(nm[i]) == static_cast<double>(static_cast<float>(v[i])));
    CHECK(c.at(402.5) == doctest::Approx(0.35).epsilon(1e-6));
    CHECK(c.at(365.0) == doctest::Approx(0.1));
    CHECK(c.at(829.0) == doctest::Approx(0.9));
    CHECK(SampledCurve::fromPoints(std::array{500.0}, std::array{0.5}).isConstant());
}

TEST_CASE("emission keeps its energy, wherever the lines are") {
    // A triangular line 0.3 nm wide: point samples at whole nanometres would miss it altogether.
    for (const double centre : {400.5, 546.07, 589.3, 612.999, 700.0}) {
        const double nm[] = {centre - 0.15, centre, centre + 0.15}, v[] = {0, 20, 0};
        const SampledCurve c = SampledCurve::fromEmissionPoints(nm, v);
        CHECK(integral(c) == doctest::Approx(3).epsilon(1e-6));
        double moment = 0;
        for (int i = 360; i <= 830; ++i) moment += c.at(static_cast<double>(i)) * i;
        CHECK(moment / 3 == doctest::Approx(centre).epsilon(1e-7));
    }
    const double nm[] = {360, 830}, v[] = {100, 100};
    CHECK(SampledCurve::fromEmissionPoints(nm, v).isConstant());
    // Data that end inside the table: zero beyond.
    const double part[] = {500.25, 600.5}, one[] = {1, 1};
    const SampledCurve box = SampledCurve::fromEmissionPoints(part, one);
    CHECK(integral(box) == doctest::Approx(100.25).epsilon(1e-7));
    CHECK(box.at(498.0) == 0);
    CHECK(box.at(550.0) == 1);
    CHECK(box.at(602.0) == 0);
    // Data that reach beyond the table are cut at its ends.
    const double wide[] = {100, 2000};
    CHECK(integral(SampledCurve::fromEmissionPoints(wide, one)) == doctest::Approx(470).epsilon(1e-9));
}

TEST_CASE("a light with lines keeps its colour when resampled") {
    // FL11, integrated once in the table and once as a fine sum over the linearly interpolated data.
    const auto light = findIlluminant("FL11");
    REQUIRE(light);
    const auto curve = illuminantCurve(*light);
    Xyz direct;
    constexpr int parts = 20;
    for (std::size_t i = 0; i + 1 < light->values.size(); ++i)
        for (int p = 0; p < 5 * parts; ++p) {
            const double f = (p + 0.5) / (5 * parts), nm = light->firstNm + 5 * (static_cast<double>(i) + f);
            const double power = light->values[i] + (light->values[i + 1] - light->values[i]) * f;
            const Wavelengths w = Wavelengths::single(static_cast<float>(nm));
            direct += Xyz{xbar(w)[0], ybar(w)[0], zbar(w)[0]} * (power / parts);
        }
    const Xyz table = integrate(*curve);
    CHECK(table.y == doctest::Approx(1).epsilon(1e-6));
    CHECK(table.x == doctest::Approx(direct.x / direct.y).epsilon(1e-3));
    CHECK(table.z == doctest::Approx(direct.z / direct.y).epsilon(1e-3));
    // The sum at every nanometre of the interpolated data is case 50 of tests/hard_cases.
}

TEST_CASE("constants know that they are constant") {
    const ConstantCurve c(0.18);
    CHECK(c.isConstant());
    CHECK(c.at(Wavelengths::sample(0.1f))[4] == 0.18f);
    CHECK(SampledCurve([](double) { return 0.18; }).isConstant());
}
