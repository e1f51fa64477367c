#include "study/curve_fits.h"
#include "study/curve_statistics.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

const std::vector<std::uint32_t> kLadder{4, 8, 16, 32, 64, 128};

// Errors that fall by a known law. Each rung takes half of its deviation from the rung before, as renders that go on
// do.
struct MadeCurve {
    double scale = 0.1, power = -1, floor = 0, sigma = 0.1, secondsPerSample = 0.01, fixedSeconds = 0;

    double errorAt(double n) const { return floor + scale * std::pow(n, power); }
    CurveStatistics make(std::uint64_t study, std::size_t seeds = 8, std::uint64_t firstSeed = 1) const {
        std::vector<SeedRun> runs;
        for (std::size_t s = 0; s < seeds; ++s) {
            test::Random random(1000 * study + s + firstSeed);
            SeedRun run{firstSeed + s, {}};
            double deviation = normal(random);
            for (const std::uint32_t n : kLadder) {
                deviation = 0.5 * deviation + std::sqrt(0.75) * normal(random);
                const double falling = scale * std::pow(n, power) * std::exp(sigma * deviation - sigma * sigma / 2);
                const double seconds = fixedSeconds + secondsPerSample * n;
                run.rungs.push_back(
                    {floor + falling, 0.9 * falling, seconds, 2 * seconds, n, 2 * secondsPerSample * n});
            }
            runs.push_back(run);
        }
        return CurveStatistics(kLadder, runs);
    }
    static double normal(test::Random& random) {
        return std::sqrt(-2 * std::log(random.uniformDouble())) * std::cos(6.283185307179586 * random.uniformDouble());
    }
};

template <typename Interval> int covered(const MadeCurve& curve, double truth, Interval interval, int studies = 500) {
    int inside = 0;
    for (int study = 0; study < studies; ++study) {
        const Estimate e = interval(curve.make(static_cast<std::uint64_t>(study)));
        inside += e.low <= truth && truth <= e.high;
    }
    return inside;
}

} // namespace

TEST_CASE("slopes of 500 made studies lie within their intervals") {
    for (const double power : {-1.0, -1.4})
        for (const double sigma : {0.02, 0.2}) {
            CAPTURE(power);
            CAPTURE(sigma);
            MadeCurve curve;
            curve.power = power;
            curve.sigma = sigma;
            const int inside = covered(curve, power, [](const CurveStatistics& s) { return s.slope(); });
            CHECK(inside >= 450);
            CHECK(inside <= 495);
        }
}

TEST_CASE("slope and cost of halving the noise without any noise") {
    MadeCurve curve;
    curve.sigma = 0;
    CHECK(curve.make(1).slope().value == doctest::Approx(-1));
    CHECK(curve.make(1).halfNoiseCost().value == doctest::Approx(4));
    curve.power = -2;
    CHECK(curve.make(1).halfNoiseCost().value == doctest::Approx(2));
}

TEST_CASE("a floor is found where there is one and nowhere else") {
    MadeCurve curve;
    curve.sigma = 0.05;
    curve.scale = 0.01;
    const auto floor = [](const CurveStatistics& s) { return s.floor(); };
    // The error of 128 samples is 8e-5. Without a floor:
    const int none = covered(curve, 0, floor, 100);
    CHECK(none >= 90);
    // A bias of 1 %:
    curve.floor = 1e-4;
    const int right = covered(curve, 1e-4, floor, 100);
    CHECK(right >= 90);
    const int found = 100 - covered(curve, 0, floor, 100);
    CHECK(found >= 95);
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

TEST_CASE("times to an error lie within their intervals") {
    MadeCurve curve;
    curve.sigma = 0.2;
    for (const double n : {50.0, 1000.0}) {
        CAPTURE(n);
        const auto seconds = [&](const CurveStatistics& s) { return s.timeTo(std::sqrt(0.1 / n), {}).seconds; };
        const int inside = covered(curve, 0.01 * n, seconds);
        CHECK(inside >= 450);
        CHECK(inside <= 495);
    }
}

TEST_CASE("efficiency against another curve at equal time") {
    MadeCurve main, slow; // of twice the error in three times the time
    slow.scale = 0.2;
    slow.secondsPerSample = 0.03;
    main.sigma = slow.sigma = 0;
    CHECK(slow.make(2).efficiencyAgainst(main.make(1), TimeBasis::sampling).value == doctest::Approx(1.0 / 6));
    CHECK(main.make(1).efficiencyAgainst(slow.make(2), TimeBasis::sampling).value == doctest::Approx(6));
    main.sigma = slow.sigma = 0.1;
    int inside = 0;
    for (std::uint64_t study = 0; study < 500; ++study) {
        const Estimate e = slow.make(2 * study + 1).efficiencyAgainst(main.make(2 * study + 2), TimeBasis::sampling);
        inside += e.low <= 1.0 / 6 && 1.0 / 6 <= e.high;
    }
    CHECK(inside >= 450);
    CHECK(inside <= 495);
    // One that begins only when the other is done: that one is continued by its slope.
    main.sigma = slow.sigma = 0;
    slow.secondsPerSample = 1;
    CHECK(slow.make(1).efficiencyAgainst(main.make(1), TimeBasis::sampling).value == doctest::Approx(0.005));
    // One that rises is not continued.
    main.power = 0.5;
    CHECK_FALSE(slow.make(1).efficiencyAgainst(main.make(1), TimeBasis::sampling).known());
    main.power = -1;
    // No seed in common.
    CHECK_FALSE(slow.make(1, 8, 101).efficiencyAgainst(main.make(1), TimeBasis::sampling).known());
}

TEST_CASE("times that vary count in the intervals of what is told in time") {
    // Every third seed met a machine that was busy: half as long again. The median does not see it.
    MadeCurve curve;
    curve.sigma = 0.05;
    int inside = 0;
    double width = 0, quietWidth = 0;
    for (std::uint64_t study = 0; study < 300; ++study) {
        const CurveStatistics quiet = curve.make(study);
        std::vector<SeedRun> runs(quiet.runs().begin(), quiet.runs().end());
        test::Random random(study + 1);
        for (SeedRun& run : runs) {
            const double busy = random.uniformDouble() < 0.33 ? 1.5 : 1 + 0.02 * random.uniformDouble();
            for (RungRun& rung : run.rungs) rung.seconds *= busy;
        }
        const CurveStatistics noisy(kLadder, runs);
        const Estimate time = noisy.timeTo(std::sqrt(0.1 / 50), {}).seconds;
        inside += time.low <= 0.505 && 0.505 <= time.high;
        width += time.high - time.low;
        const Estimate before = quiet.timeTo(std::sqrt(0.1 / 50), {}).seconds;
        quietWidth += before.high - before.low;
    }
    CHECK(inside >= 276);
    CHECK(width > 1.5 * quietWidth);
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
