// Keys on a grid of equally spaced times.
#include "math/key_grid.h"

#include <array>
#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

// Whether linear interpolation of the steps says the same as that of the keys, whose state is their own number.
double largestDifference(const std::vector<double>& times, const KeyGrid& grid, Interval interval) {
    double worst = 0;
    const auto state = [](KeyPosition p) { return static_cast<double>(p.key) + p.fraction; };
    for (int i = 0; i <= 1000; ++i) {
        const double x = i / 1000.0, scaled = x * static_cast<double>(grid.steps.size() - 1);
        const auto step = std::min(static_cast<std::size_t>(scaled), grid.steps.size() - 2);
        const double a = state(grid.steps[step]), b = state(grid.steps[step + 1]);
        const double met = a + (b - a) * (scaled - static_cast<double>(step));
        worst = std::max(worst, std::abs(met - state(keyPosition(times, interval.open + x * interval.duration))));
    }
    return worst;
}

} // namespace

TEST_CASE("key grid: where a time lies among keys") {
    const std::array<double, 3> times{-1, 1, 2};
    CHECK(keyPosition(times, -5) == KeyPosition{0, 0});
    CHECK(keyPosition(times, -1) == KeyPosition{0, 0});
    CHECK(keyPosition(times, 0) == KeyPosition{0, 0.5});
    CHECK(keyPosition(times, 1) == KeyPosition{1, 0});
    CHECK(keyPosition(times, 1.75) == KeyPosition{1, 0.75});
    CHECK(keyPosition(times, 2) == KeyPosition{2, 0});
    CHECK(keyPosition(times, 7) == KeyPosition{2, 0});
}

TEST_CASE("key grid: keys on a grid are kept exactly, with as few steps as can be") {
    const auto steps = [](const std::vector<double>& times, Interval interval) {
        const KeyGrid grid = makeKeyGrid(times, interval, 129);
        CHECK(grid.offGrid.empty());
        CHECK(largestDifference(times, grid, interval) < 1e-6);
        return grid.steps.size();
    };
    CHECK(steps({0, 1}, {0, 1}) == 2);
    CHECK(steps({0, 1}, {0.25, 0.5}) == 2); // cut at both ends
    CHECK(steps({0, 0.5, 1}, {0, 1}) == 3);
    CHECK(steps({0, 1.0 / 3, 1}, {0, 1}) == 4); // a third needs three parts
    CHECK(steps({0, 1 / 48.0, 1 / 24.0}, {0, 1 / 24.0}) == 3);
    CHECK(steps({0.25, 0.75}, {0, 1}) == 5);        // held before and after
    CHECK(steps({0, 1, 2, 3}, {0.5, 2}) == 5);      // keys at 1/4 and 3/4 of the interval
    CHECK(steps({0, 1 / 128.0, 1}, {0, 1}) == 129); // the finest there is
    CHECK(steps({100, 100.01, 100.02}, {100, 0.02}) == 3);
}

TEST_CASE("key grid: exact keys are copied, not interpolated") {
    const std::vector<double> times{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1};
    const KeyGrid grid = makeKeyGrid(times, {0, 1}, 129);
    REQUIRE(grid.steps.size() == times.size());
    for (std::size_t i = 0; i < times.size(); ++i) CHECK(grid.steps[i] == KeyPosition{i, 0});
}

TEST_CASE("key grid: what does not change in the interval is one step") {
    const std::vector<double> times{0, 1};
    CHECK(makeKeyGrid(times, {2, 1}, 129).steps == std::vector{KeyPosition{1, 0}});
    CHECK(makeKeyGrid(times, {-3, 2}, 129).steps == std::vector{KeyPosition{0, 0}});
    CHECK(makeKeyGrid(times, {0.25, 0}, 129).steps == std::vector{KeyPosition{0, 0.25}}); // no duration
    CHECK(makeKeyGrid(std::vector<double>{0.5}, {0, 1}, 129).steps.size() == 1);
}

TEST_CASE("key grid: keys off every grid are approached, and named") {
    const std::vector<double> times{0, 0.3137, 1};
    const Interval interval{0, 1};
    const KeyGrid grid = makeKeyGrid(times, interval, 129);
    CHECK(grid.steps.size() == 129);
    REQUIRE(grid.offGrid.size() == 1);
    CHECK(grid.offGrid[0].key == 1);
    CHECK((static_cast<double>(grid.offGrid[0].step) + grid.offGrid[0].fraction) / 128 == doctest::Approx(0.3137));
    const double off = largestDifference(times, grid, interval);
    CHECK(off > 1e-4);
    CHECK(off < 2.0 / 128); // less than what happens in a step or two
    // 3 keys that would fit 6 parts, when only 4 are allowed.
    CHECK(makeKeyGrid(std::vector<double>{0, 0.5, 2 / 3.0, 1}, interval, 5).offGrid.size() == 1);
}
