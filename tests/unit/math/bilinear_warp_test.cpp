#include "math/bilinear_warp.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

namespace abbe {
namespace {

// Two tables of 5 × 7, one with rows and columns of 0.
BilinearWarp unevenWarp() {
    std::vector<float> values;
    std::mt19937 random(3);
    for (int table = 0; table < 2; ++table)
        for (int r = 0; r < 5; ++r)
            for (int c = 0; c < 7; ++c)
                values.push_back(table == 1 && (r == 1 || c == 0) ? 0.f
                                                                  : 0.05f + static_cast<float>(random() % 1000) / 300);
    return BilinearWarp(std::move(values), 5, 7);
}

TEST_CASE("a bilinear warp: there and back, and its density is what its map makes of areas") {
    const BilinearWarp warp = unevenWarp();
    std::mt19937 random(4);
    const auto uniform = [&] { return (random() + 0.5) / 4294967296.0; };
    for (const double part : {0.0, 0.35, 1.0})
        for (int i = 0; i < 2000; ++i) {
            const TableBlend blend = blendTables({0, 0}, {0, part}, 2);
            const Vec2d u(uniform() * 0.999, uniform() * 0.999);
            const auto there = warp.sample(blend, u);
            const auto back = warp.invert(blend, there.at);
            REQUIRE(back.at.x == doctest::Approx(u.x).epsilon(1e-4));
            REQUIRE(back.at.y == doctest::Approx(u.y).epsilon(1e-4));
            REQUIRE(back.density == doctest::Approx(there.density).epsilon(1e-6));
            REQUIRE(warp.density(blend, there.at) == doctest::Approx(there.density).epsilon(1e-6));
        }
}

TEST_CASE("a bilinear warp: the Jacobian of its map, and ∫ density = 1") {
    const BilinearWarp warp = unevenWarp();
    const TableBlend blend = blendTables({0, 0}, {0, 0.35}, 2);
    double total = 0, worst = 0;
    constexpr int n = 480; // a multiple of the cells of both sides
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec2d at((i + 0.5) / n, (j + 0.5) / n);
            const double density = warp.density(blend, at), h = 1e-4;
            total += density / (n * n);
            if (i % 16 != 3 || j % 16 != 5) continue;
            const auto u = [&](double dx, double dy) { return warp.invert(blend, {at.x + dx, at.y + dy}).at; };
            const Vec2d x = (u(h, 0) - u(-h, 0)) * (0.5 / h), y = (u(0, h) - u(0, -h)) * (0.5 / h);
            worst = std::max(worst, std::abs(x.x * y.y - x.y * y.x - density) / density);
        }
    CHECK(total == doctest::Approx(1).epsilon(1e-4));
    CHECK(worst < 0.02);
}

TEST_CASE("places among values, and what lies outside") {
    const std::vector<float> values = {1, 2, 4};
    CHECK(placeOnAxis(values, 3).index == 1);
    CHECK(placeOnAxis(values, 3).fraction == 0.5);
    CHECK(placeOnAxis(values, 0).fraction == 0);
    CHECK(placeOnAxis(values, 9).index == 1);
    CHECK(placeOnAxis(values, 9).fraction == 1);
    CHECK(placeOnAxis(std::vector<float>{5}, 9).fraction == 0);
}

} // namespace
} // namespace abbe
