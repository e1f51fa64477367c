// Passes, the pilot, and Russian roulette's reference.
#include "rendering/time_left.h"
#include "support/chi_square.h"
#include "transport/roulette.h"

#include <doctest/doctest.h>
#include <functional>

namespace abbe::test {
namespace {

PilotFilm pilotOf(PixelBounds frame, const std::function<double(int, int)>& luminance) {
    PilotFilm pilot(frame, 1);
    for (int row = 0; row < pilot.rows(); ++row)
        for (int column = 0; column < pilot.columns(); ++column) {
            const PixelBounds p = pilot.pixelOf(column, row);
            pilot.add(p.x0, p.y0, 0, Xyz{0, 4 * luminance(p.x0, p.y0), 0}, 4);
        }
    return pilot;
}

} // namespace

TEST_CASE("passes end at powers of two and at quarters between them, whatever the goal") {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t end = 0; end < 128;) {
        end = passEnd(end);
        ends.push_back(end);
    }
    CHECK(ends == std::vector<std::uint32_t>{2, 4, 8, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 112, 128});
    // Up to the last sample that the renderer can count: strictly forwards, by a quarter at most, through every power.
    std::uint64_t first = 16, power = 32;
    while (first < 1u << 31) {
        const std::uint32_t end = passEnd(static_cast<std::uint32_t>(first));
        REQUIRE(end > first);
        CHECK(end - first <= first / 4);
        if (end >= power) {
            CHECK(end == power);
            power *= 2;
        }
        first = end;
    }
}

TEST_CASE("roulette: survival follows the throughput between the floor and certainty") {
    CHECK(RouletteReference::survival(0.5f, 1) == 0.5f);
    CHECK(RouletteReference::survival(0.5f, 0.5f) == 0.25f);
    CHECK(RouletteReference::survival(3, 1) == 1);
    CHECK(RouletteReference::survival(0, 1) == RouletteReference::kFloor);
    CHECK(RouletteReference::survival(1e-30f, 1e-30f) == RouletteReference::kFloor);
    CHECK(RouletteReference::survival(kInfinity, 1) == 1);
    CHECK(RouletteReference::kFloor == 0.05f);
}

TEST_CASE("roulette: the reference of an even frame is the threshold everywhere") {
    const float average = RouletteReference().scale(3, 3);
    CHECK(average == doctest::Approx(1 / RouletteReference::kThreshold));
    const RouletteReference black(pilotOf({0, 0, 9, 7}, [](int, int) { return 0.0; })); // nothing seen
    CHECK(black.scale(3, 3) == average);
    const RouletteReference even(pilotOf({0, 0, 9, 7}, [](int, int) { return 5.0; }));
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x) CHECK(even.scale(x, y) == doctest::Approx(average));
}

TEST_CASE("roulette: bright pixels need brighter paths, and dark ones count as the median") {
    // A fifth of the frame is five times as bright as the rest; cells are 2×2 pixels.
    const PixelBounds frame{0, 0, 60, 20};
    const RouletteReference reference(pilotOf(frame, [](int x, int) { return x < 12 ? 5.0 : 1.0; }));
    const double average = 1.8, t = RouletteReference::kThreshold;
    CHECK(reference.scale(1, 9) == doctest::Approx(average / (t * 5)));
    CHECK(reference.scale(40, 9) == doctest::Approx(average / t));
    // 5 cells wide about cell 5 (pixels 10 and 11), then linear between centres of cells.
    const double five = (3 * 5 + 2 * 1) / 5.0, six = (2 * 5 + 3 * 1) / 5.0;
    CHECK(reference.scale(11, 9) == doctest::Approx(average / (t * (0.75 * five + 0.25 * six))));
    // Black pixels beside lit ones.
    const RouletteReference half(pilotOf(frame, [](int x, int) { return x < 20 ? 0.0 : 2.0; }));
    CHECK(half.scale(0, 0) == doctest::Approx(2.0 * 40 / 60 / (t * 2)));
    // Even where more than half is black, survival stays defined.
    const RouletteReference dark(pilotOf(frame, [](int x, int) { return x < 50 ? 0.0 : 2.0; }));
    for (int x = 0; x < 60; ++x) CHECK_UNARY(dark.scale(x, 0) > 0 && std::isfinite(dark.scale(x, 0)));
}

TEST_CASE("roulette: one cell a thousand times as bright as the rest counts as bright and no more") {
    const RouletteReference reference(
        pilotOf({0, 0, 64, 64}, [](int x, int y) { return x / 2 == 16 && y / 2 == 16 ? 1000.0 : 1.0; }));
    // 8 times the rest in one cell of 25.
    CHECK(reference.scale(33, 33) > 0.7f * reference.scale(0, 0));
    CHECK(reference.scale(33, 33) < 0.9f * reference.scale(0, 0));
}

TEST_CASE("the pilot looks at one pixel in each of at most 128 by 128 cells, by the frame and the seed alone") {
    for (const PixelBounds frame : {PixelBounds{0, 0, 1, 1},
                                    {0, 0, 37, 21},
                                    {0, 0, 256, 256},
                                    {0, 0, 257, 256},
                                    {0, 0, 65536, 1},
                                    {0, 0, 7680, 4320}}) {
        const PilotFilm pilot(frame, 7), again(frame, 7), other(frame, 8);
        CHECK(pilot.columns() * pilot.rows() <= 128 * 128);
        int moved = 0;
        for (int row = 0; row < pilot.rows(); ++row)
            for (int column = 0; column < pilot.columns(); ++column) {
                const PixelBounds p = pilot.pixelOf(column, row);
                REQUIRE(
                    (p.area() == 1 && p.x0 >= frame.x0 && p.y0 >= frame.y0 && p.x1 <= frame.x1 && p.y1 <= frame.y1));
                REQUIRE((p.x0 / pilot.cellSize() == column && p.y0 / pilot.cellSize() == row));
                REQUIRE((again.pixelOf(column, row).x0 == p.x0 && again.pixelOf(column, row).y0 == p.y0));
                moved += other.pixelOf(column, row).x0 != p.x0;
            }
        if (frame.area() > 1000) CHECK(moved > pilot.columns() * pilot.rows() / 4);
    }
    CHECK(PilotFilm({0, 0, 256, 256}, 7).cellSize() == 2);
    CHECK(PilotFilm({0, 0, 257, 256}, 7).cellSize() == 4);
}

TEST_CASE("the pilot's rays: of the cells that a rectangle touches, or of those next to it") {
    PilotFilm pilot({0, 0, 6, 4}, 1); // 3 × 2 cells
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column)
            pilot.noteRays(column, row, PilotFilm::kSamples * static_cast<std::uint64_t>(10 * row + column));
    CHECK(pilot.rays({2, 0, 4, 2}) == 1);
    CHECK(pilot.rays({0, 0, 6, 4}) == 6);
    CHECK(pilot.rays({3, 1, 5, 3}) == (1 + 2 + 11 + 12) / 4.0);
    CHECK(pilot.rays({-9, -9, -1, -1}) == 0); // overscan
    CHECK(pilot.rays({6, 4, 20, 20}) == 12);
    CHECK(pilot.rays({-8, 0, 20, 2}) == 1);
}

} // namespace abbe::test
