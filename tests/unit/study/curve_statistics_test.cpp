#include "study/curve_fits.h"
#include "study/curve_statistics.h"
#include "support/made_curve.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;
using test::kLadder;
using test::MadeCurve;

TEST_CASE("slope and cost of halving the noise without any noise") {
    MadeCurve curve;
    curve.sigma = 0;
    CHECK(curve.make(1).slope().value == doctest::Approx(-1));
    CHECK(curve.make(1).halfNoiseCost().value == doctest::Approx(4));
    curve.power = -2;
    CHECK(curve.make(1).halfNoiseCost().value == doctest::Approx(2));
}

TEST_CASE("the fit with a floor recovers what made the figures") {
    std::vector<double> x, y, errors;
    for (const std::uint32_t n : kLadder) {
        x.push_back(n);
        y.push_back(3e-5 + 0.02 * std::pow(n, -1.3));
        errors.push_back(0.01 * y.back());
    }
    const auto law = FlooredLaw::fit(x, y, errors);
    REQUIRE(law);
    CHECK(law->floor == doctest::Approx(3e-5).epsilon(0.01));
    CHECK(law->power == doctest::Approx(-1.3).epsilon(0.001));
    CHECK(law->scale == doctest::Approx(0.02).epsilon(0.01));
    x.resize(3), y.resize(3), errors.resize(3);
    CHECK_FALSE(FlooredLaw::fit(x, y, errors));
}

TEST_CASE("the time to an error, within the ladder and beyond") {
    MadeCurve curve; // 0.1/n in 0.01 n s: an error of e at n = 0.1/e²
    curve.sigma = 0;
    const CurveStatistics s = curve.make(1);
    const TimeToError within = s.timeTo(std::sqrt(0.1 / 50), {});
    CHECK_FALSE(within.extrapolated);
    CHECK(within.samples == doctest::Approx(50));
    CHECK(within.seconds.value == doctest::Approx(0.5));
    const TimeToError beyond = s.timeTo(std::sqrt(0.1 / 1000), {});
    CHECK(beyond.extrapolated);
    CHECK(beyond.seconds.value == doctest::Approx(10));
    const TimeToError before = s.timeTo(std::sqrt(0.1 / 2), {});
    CHECK(before.extrapolated);
    CHECK(before.samples == doctest::Approx(2));
    curve.floor = 1e-3;
    curve.sigma = 0.02;
    const CurveStatistics flat = curve.make(1);
    const TimeToError never = flat.timeTo(0.01, flat.floor());
    CHECK_FALSE(never.reachable);
    CHECK_FALSE(never.seconds.known());
    CHECK_FALSE(s.timeTo(1e-6, {}).seconds.known()); // 10^11 samples
}

TEST_CASE("efficiency against another curve at equal time") {
    MadeCurve main, slow; // of twice the error in three times the time
    slow.scale = 0.2;
    slow.secondsPerSample = 0.03;
    main.sigma = slow.sigma = 0;
    CHECK(slow.make(2).efficiencyAgainst(main.make(1), TimeBasis::sampling).value == doctest::Approx(1.0 / 6));
    CHECK(main.make(1).efficiencyAgainst(slow.make(2), TimeBasis::sampling).value == doctest::Approx(6));
    // One that begins only when the other is done: that one is continued by its slope.
    slow.secondsPerSample = 1;
    CHECK(slow.make(1).efficiencyAgainst(main.make(1), TimeBasis::sampling).value == doctest::Approx(0.005));
    // One that rises is not continued.
    main.power = 0.5;
    CHECK_FALSE(slow.make(1).efficiencyAgainst(main.make(1), TimeBasis::sampling).known());
    main.power = -1;
    // No seed in common.
    CHECK_FALSE(slow.make(1, 8, 101).efficiencyAgainst(main.make(1), TimeBasis::sampling).known());
}

TEST_CASE("time: what is fixed is told from what samples take") {
    MadeCurve curve;
    curve.fixedSeconds = 3;
    const auto time = curve.make(1).time();
    REQUIRE(time);
    CHECK(time->fixed == doctest::Approx(3));
    CHECK(time->perSample == doctest::Approx(0.01));
    const std::vector<double> samples{4, 8, 16}, falling{3, 2, 1}, broken{0, 1, 2};
    CHECK_FALSE(TimeModel::fit(samples, falling));
    CHECK_FALSE(TimeModel::fit(samples, broken));
    CHECK_FALSE(TimeModel::fit(std::span(samples).first(1), std::span(falling).first(1)));
    const std::vector<double> steep{1, 3, 9};
    CHECK(TimeModel::fit(samples, steep)->fixed == 0); // not below
}

// As on small pictures: 1.28 s of samples after pilots of 3 s, against the same without pilots and with twice the
// error.
TEST_CASE("efficiency: pilots of one curve are not speed of the other") {
    MadeCurve main, bare;
    main.fixedSeconds = 3;
    bare.scale = 0.2;
    main.sigma = bare.sigma = 0.05;
    const CurveStatistics a = main.make(1), b = bare.make(2);
    const Estimate sampling = b.efficiencyAgainst(a, TimeBasis::sampling);
    CHECK(sampling.low <= 0.5);
    CHECK(sampling.high >= 0.5);
    CHECK(sampling.high < 0.6);
    CHECK(b.efficiencyAgainst(a, TimeBasis::whole).value > 10); // "sooner", but for the pilots alone
    // Times to an error are those on the wall, and what is fixed does not grow with them.
    CHECK(a.timeTo(std::sqrt(0.1 / 1280), {}).seconds.value == doctest::Approx(3 + 12.8).epsilon(0.1));
}

TEST_CASE("bounds that nobody knows are none") {
    // Of an error that cannot be told from 0 the inverse has no upper bound.
    MadeCurve main, lost;
    lost.scale = 1e-5;
    const CurveStatistics sharp = lost.make(3);
    std::vector<SeedRun> runs(sharp.runs().begin(), sharp.runs().end());
    for (std::size_t s = 0; s < runs.size(); ++s)
        for (RungRun& rung : runs[s].rungs) rung.relMse = (s % 4 == 0 ? 1e-3 : 1e-7) / static_cast<double>(rung.rays);
    const Estimate ratio = CurveStatistics(kLadder, runs).efficiencyAgainst(main.make(1), TimeBasis::sampling);
    CHECK(ratio.known());
    CHECK(std::isinf(ratio.high));
    CHECK(std::isfinite(ratio.low));
    // Nor does the cost of halving a noise that hardly falls.
    MadeCurve flat;
    flat.power = -0.2;
    flat.sigma = 0.3;
    const Estimate cost = flat.make(1).halfNoiseCost();
    CHECK((!cost.known() || std::isinf(cost.high)));
    flat.power = -0.01;
    flat.sigma = 0;
    CHECK_FALSE(flat.make(1).halfNoiseCost().known());
    // And nothing is compared far beyond its ladder.
    MadeCurve late;
    late.secondsPerSample = 1000;
    CHECK_FALSE(late.make(1).efficiencyAgainst(main.make(1), TimeBasis::sampling).known());
}
