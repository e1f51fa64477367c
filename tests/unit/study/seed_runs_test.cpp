#include "study/seed_runs.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <limits>
#include <numeric>

using namespace abbe;

namespace {

double normal(test::Random& random) {
    return std::sqrt(-2 * std::log(random.uniformDouble())) * std::cos(6.283185307179586 * random.uniformDouble());
}

// How many of 500 sets of `seeds` values have their true mean inside of the interval.
template <typename Draw, typename Interval> int covered(std::size_t seeds, double truth, Draw draw, Interval interval) {
    int inside = 0;
    for (std::uint64_t study = 0; study < 500; ++study) {
        test::Random random(study + 1);
        std::vector<double> values;
        for (std::size_t s = 0; s < seeds; ++s) values.push_back(draw(random));
        const Estimate e = interval(values);
        inside += e.low <= truth && truth <= e.high;
    }
    return inside;
}

Estimate bootstrapMean(const std::vector<double>& values) {
    return SeedBootstrap(values.size()).estimate([&](std::span<const double> w) {
        return std::optional(std::inner_product(w.begin(), w.end(), values.begin(), 0.0) /
                             static_cast<double>(values.size()));
    });
}

} // namespace

TEST_CASE("intervals of the mean of few seeds hold what they promise") {
    for (const std::size_t seeds : {5u, 8u, 16u}) {
        CAPTURE(seeds);
        // Errors of images are lognormal at worst, as wide as single bright pixels make them.
        for (const double sigma : {0.05, 0.3}) {
            CAPTURE(sigma);
            const double truth = std::exp(sigma * sigma / 2);
            const auto draw = [&](test::Random& r) { return std::exp(sigma * normal(r)); };
            const int onLogScale = covered(seeds, truth, draw, [](const auto& v) { return meanOnLogScale(v); });
            CHECK(onLogScale >= 450);
            CHECK(onLogScale <= 495);
            const int drawn = covered(seeds, truth, draw, bootstrapMean);
            CHECK(drawn >= 450);
            CHECK(drawn <= 495);
        }
    }
}

TEST_CASE("the interval of a mean") {
    const std::vector<double> values{1, 2, 3, 4};
    const Estimate plain = meanWithStudent(values);
    CHECK(plain.value == 2.5);
    CHECK(plain.high - 2.5 == doctest::Approx(3.1824463 * std::sqrt(5.0 / 3 / 4)));
    const Estimate log = meanOnLogScale(values);
    CHECK(log.low > 0);
    CHECK(log.high / log.value == doctest::Approx(log.value / log.low));
    CHECK_FALSE(meanOnLogScale(std::vector<double>{2.0}).bounded());
    const std::vector<double> around{-1, 1, -1, 1.5}; // a reference as noisy as the image
    CHECK(meanOnLogScale(around).low < 0);
}

TEST_CASE("a figure that some seeds do not have") {
    const SeedBootstrap bootstrap(8);
    CHECK_FALSE(bootstrap.estimate([](auto) { return std::optional<double>(); }).known());
    // Without the first seed nothing is known: two thirds of the resamples have it.
    const Estimate e =
        bootstrap.estimate([](std::span<const double> w) { return w[0] > 0 ? std::optional(1.0) : std::nullopt; });
    CHECK(e.known());
    CHECK_FALSE(e.bounded());
    CHECK_FALSE(SeedBootstrap(4).estimate([](auto) { return std::optional(1.0); }).bounded());
}

namespace {

// Rungs of a ladder until it ends, of at most ten.
std::vector<RungRun> ladder(double fixed, double first, double mainSeconds) {
    std::vector<RungRun> rungs;
    for (double seconds = first; rungs.size() < 10; seconds *= 2) {
        rungs.push_back({0, 0, fixed + seconds, 0, 0});
        if (!worthAnotherRung(rungs, mainSeconds)) break;
    }
    return rungs;
}

} // namespace

TEST_CASE("a ladder ends near the time of the main curve") {
    // Ten rungs of the main one end after 10 s.
    const double mainFirst = 10.0 / 512;
    CHECK(ladder(0, mainFirst, 10).size() == 10);
    for (const double slower : {1.0, 1.3, 1.7, 2.0, 3.0, 7.0, 50.0}) {
        CAPTURE(slower);
        const auto rungs = ladder(0, slower * mainFirst, 10);
        CHECK(rungs.back().seconds <= 16);
        CHECK(rungs.back().seconds > 8);
    }
    // What is far too slow has two rungs all the same: a line needs them.
    CHECK(ladder(0, 100, 10).size() == 2);
}

TEST_CASE("a part that does not grow with the samples is not doubled") {
    // A denoiser of 5 s for each image: 5 s and the time of samples, which fit up to 11 s.
    const auto rungs = ladder(5, 10.0 / 512, 10);
    CHECK(rungs.size() == 10);
    CHECK(rungs.back().seconds == doctest::Approx(15));
}

TEST_CASE("short ladders are never cut") {
    CHECK(ladder(0, 0.2 / 512, 0.01).size() == 10);
    CHECK(ladder(0, 1, std::numeric_limits<double>::infinity()).size() == 10);
}
