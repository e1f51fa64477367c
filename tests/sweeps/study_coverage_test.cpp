// Intervals of `abbe study`: of hundreds of made studies they hold the truth as often as they say.
#include "support/made_curve.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

template <typename Interval> int covered(const MadeCurve& curve, double truth, Interval interval, int studies = 500) {
    int inside = 0;
    for (int study = 0; study < studies; ++study) {
        const abbe::Estimate e = interval(curve.make(static_cast<std::uint64_t>(study)));
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

TEST_CASE("times that vary count in the intervals of what is told in time") {
    // Every third seed met a machine that was busy: half as long again. The median does not see it.
    MadeCurve curve;
    curve.sigma = 0.05;
    int inside = 0;
    double width = 0, quietWidth = 0;
    for (std::uint64_t study = 0; study < 300; ++study) {
        const CurveStatistics quiet = curve.make(study);
        std::vector<SeedRun> runs(quiet.runs().begin(), quiet.runs().end());
        Random random(study + 1);
        for (SeedRun& run : runs) {
            const double busy = random.uniformDouble() < 0.33 ? 1.5 : 1 + 0.02 * random.uniformDouble();
            for (RungRun& rung : run.rungs) rung.seconds *= busy;
        }
        const CurveStatistics noisy(kLadder, runs);
        const abbe::Estimate time = noisy.timeTo(std::sqrt(0.1 / 50), {}).seconds;
        inside += time.low <= 0.505 && 0.505 <= time.high;
        width += time.high - time.low;
        const abbe::Estimate before = quiet.timeTo(std::sqrt(0.1 / 50), {}).seconds;
        quietWidth += before.high - before.low;
    }
    CHECK(inside >= 276);
    CHECK(width > 1.5 * quietWidth);
}

TEST_CASE("efficiencies against another curve lie within their intervals") {
    MadeCurve main, slow; // of twice the error in three times the time
    slow.scale = 0.2;
    slow.secondsPerSample = 0.03;
    main.sigma = slow.sigma = 0.1;
    int inside = 0;
    for (std::uint64_t study = 0; study < 500; ++study) {
        const abbe::Estimate e =
            slow.make(2 * study + 1).efficiencyAgainst(main.make(2 * study + 2), TimeBasis::sampling);
        inside += e.low <= 1.0 / 6 && 1.0 / 6 <= e.high;
    }
    CHECK(inside >= 450);
    CHECK(inside <= 495);
}

} // namespace abbe::test
