#include "film/error_figure.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <random>

namespace abbe::test {

namespace {

// Of a generalised Pareto distribution with scale 1.
std::vector<float> paretoSizes(double k, int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<float> sizes;
    for (int i = 0; i < count; ++i) {
        const double p = 1 - uniform(random);
        sizes.push_back(static_cast<float>(k == 0 ? -std::log(p) : std::expm1(-k * std::log(p)) / k));
    }
    return sizes;
}

// Mean and deviation over 40 lists.
std::pair<double, double> shapes(double k, int count) {
    double sum = 0, squares = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        auto sizes = paretoSizes(k, count, seed);
        const double shape = TailEstimate::of(sizes)->shape;
        sum += shape / 40;
        squares += shape * shape / 40;
    }
    return {sum, std::sqrt(squares - sum * sum)};
}

} // namespace

TEST_CASE("tail: the shape of a Pareto distribution is found") {
    for (const double k : {-0.3, 0.0, 0.2, 0.4, 0.6, 0.9}) {
        CAPTURE(k);
        const auto [mean, deviation] = shapes(k, 20000);
        CHECK(std::abs(mean - k) < 0.03);
        CHECK(deviation < 0.1);
    }
    // A tile tells less, and is drawn towards 1/2.
    CHECK(shapes(0, 256).first < 0.2);
    CHECK(shapes(0.6, 256).first > 0.5);
}

TEST_CASE("tail: light ones have all been met, heavy ones have not") {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, 1);
    std::vector<float> sizes;
    for (int i = 0; i < 4000; ++i) sizes.push_back(static_cast<float>(std::abs(normal(random))));
    const auto light = TailEstimate::of(sizes);
    REQUIRE(light);
    CHECK(light->unseen == 0);
    auto heavy = paretoSizes(0.45, 4000, 4);
    const auto tail = TailEstimate::of(heavy);
    REQUIRE(tail);
    CHECK(tail->unseen > 0);
    CHECK(tail->unseen == doctest::Approx(tail->largest / std::max(1 - 2 * tail->shape, 0.2)));
    // The mean square is 2/((1 − k)(1 − 2k)). Three of four sums fall short of it; with what is unseen no more than
    // half.
    int alone = 0, with = 0;
    for (unsigned seed = 1; seed <= 100; ++seed) {
        auto list = paretoSizes(0.35, 1500, seed);
        double squares = 0;
        for (const float v : list) squares += static_cast<double>(v) * static_cast<double>(v) / 1500;
        alone += squares > 2 / (0.65 * 0.3);
        with += squares * (1 + TailEstimate::of(list)->unseen) > 2 / (0.65 * 0.3);
    }
    MESSAGE(fmt::format("of 100 sums of squares {} reach the mean, {} with what is unseen", alone, with));
    CHECK(alone < 40);
    CHECK(with > 50);
}

TEST_CASE("tail: lists that tell nothing") {
    std::vector<float> few(99, 1.0f), zeros(1000, 0.0f), equal(1000, 2.0f), two(1000, 0.0f);
    two[3] = two[500] = 1;
    CHECK_FALSE(TailEstimate::of(few));
    CHECK_FALSE(TailEstimate::of(zeros));
    CHECK_FALSE(TailEstimate::of(equal)); // no tail
    CHECK_FALSE(TailEstimate::of(two));
}

} // namespace abbe::test
