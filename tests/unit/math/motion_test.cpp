#include "math/motion.h"

#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

double difference(const Transform& a, const Transform& b) {
    double largest = maxComponent(abs(a.t - b.t));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a.a[i][j] - b.a[i][j]));
    return largest;
}

TransformStep turn(Vec3d axis, double radians) { return {TransformStep::Kind::rotate, axis, radians, {}}; }
TransformStep move(Vec3d by) { return {TransformStep::Kind::translate, by, 0, {}}; }
TransformStep matrix(const Transform& t) { return {TransformStep::Kind::matrix, {}, 0, t}; }

} // namespace

TEST_CASE("decomposition: random maps, mirrors and scales from 1e-6 to 1e6 come back") {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 2000; ++i) {
        Transform t;
        const double scale = std::pow(10.0, static_cast<double>(i % 13) - 6);
        for (auto& row : t.a)
            for (double& x : row) x = normal(random) * scale;
        t.t = {normal(random), normal(random), normal(random)};
        const Decomposition d = Decomposition::of(t);
        CHECK(difference(d.compose(), t) <= 1e-12 * std::max(1.0, scale));
        CHECK(std::abs(d.rotation.w * d.rotation.w + lengthSquared(d.rotation.v) - 1) < 1e-12);
    }
}

TEST_CASE("decomposition: pure rotations have no stretch, pure scales no rotation") {
    const Decomposition r = Decomposition::of(Transform::rotate({1, 2, -1}, 2.9));
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) CHECK(std::abs(r.stretch[i][j] - (i == j)) < 1e-13);
    const Decomposition s = Decomposition::of(Transform::scale({2, 3, 1e-5}));
    CHECK(std::abs(s.rotation.w) == doctest::Approx(1).epsilon(1e-12));
    CHECK(s.stretch[2][2] == doctest::Approx(1e-5));
}

// docs/hard_cases.md, case 20: matrices mixed entry by entry would shrink the blade to 9 % halfway.
TEST_CASE("interpolation: a blade that turns by 170° keeps its length and turns evenly") {
    const Decomposition a = Decomposition::of({}),
                        b = Decomposition::of(Transform::rotate({0, 0, 1}, 170 * kPiD / 180));
    for (int i = 0; i <= 100; ++i) {
        const double u = i / 100.0;
        const Vec3d tip = interpolate(a, b, u).compose().point({3, 0, 0});
        CHECK(length(tip) == doctest::Approx(3).epsilon(1e-12));
        CHECK(std::atan2(tip.y, tip.x) == doctest::Approx(u * 170 * kPiD / 180).epsilon(1e-10));
    }
}

TEST_CASE("interpolation: ends are met, the shorter arc is taken, equal keys stand still") {
    const Transform from = Transform::scale({1, 2, -1}).then(Transform::rotate({1, 1, 0}, 1)),
                    to = Transform::scale({2, 1, -1}).then(Transform::rotate({0, 1, 3}, -2));
    const Decomposition a = Decomposition::of(from), b = Decomposition::of(to);
    CHECK(difference(interpolate(a, b, 0).compose(), from) < 1e-12);
    CHECK(difference(interpolate(a, b, 1).compose(), to) < 1e-12);
    CHECK(difference(interpolate(a, a, 0.3).compose(), from) < 1e-12);
    const Decomposition most = Decomposition::of(Transform::rotate({0, 0, 1}, 1.5 * kPiD)); // = -90°
    const Vec3d p = interpolate(Decomposition::of({}), most, 0.5).compose().point({1, 0, 0});
    CHECK(p.y == doctest::Approx(-std::sqrt(0.5)));
}

TEST_CASE("keyed transform: like steps interpolate their numbers, so a full turn is one") {
    const KeyedTransform fan(
        {{0, {turn({0, 1, 0}, 0), move({0, 1, 0})}}, {1, {turn({0, 1, 0}, 2 * kPiD), move({0, 3, 0})}}});
    CHECK(fan.moves());
    const Vec3d p = fan.at(0.25).point({1, 0, 0});
    CHECK(length(p - Vec3d{0, 1.5, -1}) < 1e-12);
    CHECK(difference(fan.at(-5), fan.at(0)) == 0);
    CHECK(difference(fan.at(7), fan.at(1)) == 0);
}

TEST_CASE("keyed transform: unlike steps are taken apart, any number of keys") {
    const Transform quarter = Transform::rotate({0, 0, 1}, kPiD / 2);
    const KeyedTransform k(
        std::vector<KeyedTransform::Key>{{0, {}}, {1, {matrix(quarter)}}, {3, {turn({0, 0, 1}, kPiD)}}});
    const auto angle = [&](double time) {
        const Vec3d p = k.at(time).point({1, 0, 0});
        CHECK(length(p) == doctest::Approx(1).epsilon(1e-12));
        return std::atan2(p.y, p.x);
    };
    CHECK(angle(0.5) == doctest::Approx(kPiD / 4));
    CHECK(angle(1) == doctest::Approx(kPiD / 2));
    CHECK(angle(2) == doctest::Approx(0.75 * kPiD));
    CHECK(difference(KeyedTransform().at(4), {}) == 0);
}

TEST_CASE("keyed transform: a mirror that comes or goes does not pass through nothing unnoticed") {
    // Scales of opposite sign are not mixed number by number; at the middle the taken-apart map is singular too, but
    // nowhere else, and the ends are exact.
    const auto scale = [](Vec3d s) { return TransformStep{TransformStep::Kind::scale, s, 0, {}}; };
    const KeyedTransform k(std::vector<KeyedTransform::Key>{{0, {scale({1, 1, 1})}}, {1, {scale({-1, 1, 1})}}});
    CHECK(k.at(0).determinant() == doctest::Approx(1));
    CHECK(k.at(1).determinant() == doctest::Approx(-1));
}

TEST_CASE("motion: still and moving links compose from the inside out") {
    const KeyedTransform turning(
        std::vector<KeyedTransform::Key>{{0, {turn({0, 0, 1}, 0)}}, {1, {turn({0, 0, 1}, kPiD)}}});
    const KeyedTransform rising(std::vector<KeyedTransform::Key>{{0, {move({0, 0, 0})}}, {2, {move({0, 0, 4})}}});
    const Motion arm =
        Motion(Transform::translate({1, 0, 0})).then(turning).then(Transform::scale({2, 2, 2})).then(rising);
    CHECK(arm.moves());
    // (0, 0, 0) → (1, 0, 0) → turned by 90° → (0, 1, 0) → (0, 2, 0) → (0, 2, 1).
    CHECK(length(arm.at(0.5).point({}) - Vec3d{0, 2, 1}) < 1e-12);
    CHECK(length(arm.at(9).point({}) - Vec3d{-2, 0, 4}) < 1e-12);
    const Motion still = Motion(Transform::translate({1, 2, 3})).then(KeyedTransform());
    CHECK_FALSE(still.moves());
    CHECK(length(still.at(5).point({}) - Vec3d{1, 2, 3}) == 0);
}

// Keys on a grid of equally spaced times.

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
