// The test of two pictures on numbers of known distributions: as many false alarms as the level says and no more,
// small differences are found where they are, and what nobody can judge is not judged.
#include "math/student.h"
#include "spectrum/xyz.h"
#include "verify/agreement.h"

#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <random>

namespace abbe::test {
namespace {

constexpr int kWidth = 44, kHeight = 28, kReplicates = 32; // blocks at the edges are smaller

// A film whose replicates have one sample in each pixel, all channels alike.
PixelFilm film(const std::function<double(int x, int y, int replicate)>& value) {
    PixelFilm f({0, 0, kWidth, kHeight}, PixelFilter(FilterShape::box, 0.5), kReplicates);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int r = 0; r < kReplicates; ++r) {
                const double v = value(x, y, r);
                f.add(x, y, r, ExactXyz({v, v, v}), 1);
            }
    return f;
}

// Normal around 1, with more noise on the right.
PixelFilm noisy(std::uint64_t seed, double deviation = 0.5, const std::function<double(int, int)>& factor = {}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    return film([&](int x, int y, int) {
        return (factor ? factor(x, y) : 1.0) * (1 + deviation * (1 + 0.1 * x) * normal(random));
    });
}

Agreement compareFilms(const PixelFilm& a, const PixelFilm& b, double level = 0.001) {
    return compare(TileSums(a), TileSums(b), level);
}

} // namespace

TEST_CASE("student: scores are as improbable as the t that they stand for") {
    // Two-sided quantiles of Student's t, from tables.
    struct Row {
        double freedom, t, p;
    };
    for (const Row& row : {Row{31, 2.744, 0.01}, {31, 3.633, 0.001}, {62, 3.454, 0.001}, {14, 4.140, 0.001}}) {
        CHECK(normalTwoSided(studentScore(row.t, row.freedom)) == doctest::Approx(row.p).epsilon(0.01));
        CHECK(studentOfScore(studentScore(row.t, row.freedom), row.freedom) == doctest::Approx(row.t).epsilon(1e-9));
        CHECK(studentOfScore(scoreOfTwoSided(row.p), row.freedom) == doctest::Approx(row.t).epsilon(2e-3));
    }
    CHECK(studentScore(-3, 20) == -studentScore(3, 20));
}

TEST_CASE("agreement: blocks of all sizes cover the picture once each") {
    const TileSums fine(film([](int x, int y, int) { return x + 100 * y; }));
    CHECK(fine.columns() == 6);
    CHECK(fine.rows() == 4);
    double whole = 0;
    for (TileSums t = fine;; t = t.coarser()) {
        double sum = 0;
        std::int64_t area = 0;
        for (int row = 0; row < t.rows(); ++row)
            for (int column = 0; column < t.columns(); ++column) {
                const PixelBounds b = t.bounds(column, row);
                area += b.area();
                sum += t.at(column, row).replicates[3][1];
                double own = 0;
                for (int y = b.y0; y < b.y1; ++y)
                    for (int x = b.x0; x < b.x1; ++x) own += x + 100 * y;
                CHECK(t.at(column, row).replicates[0][2] == doctest::Approx(own));
            }
        CHECK(area == kWidth * kHeight);
        if (whole == 0) whole = sum;
        CHECK(sum == doctest::Approx(whole));
        if (t.columns() * t.rows() == 1) break;
    }
}

TEST_CASE("agreement: equal expectations give false alarms at most as often as the level says") {
    int alarms = 0;
    constexpr int kRuns = 400;
    for (std::uint64_t run = 0; run < kRuns; ++run)
        alarms += !compareFilms(noisy(2 * run + 1), noisy(2 * run + 2, 1.5), 0.05).agrees();
    // Bonferroni with channels that are all alike: a third of the level, and overlapping blocks share their noise.
    MESSAGE(alarms << " alarms in " << kRuns << " runs at 5 %");
    CHECK(alarms <= 20);
    CHECK(alarms >= 1); // a test that never speaks says nothing
}

TEST_CASE("agreement: a difference of the whole is found when it is as large as the report says, and not below") {
    const PixelFilm a = noisy(1);
    const Agreement same = compareFilms(a, noisy(2));
    CHECK(same.agrees());
    CHECK(same.unjudged == 0);
    CHECK(same.tiles == 24);
    int found = 0, foundHalf = 0;
    for (std::uint64_t run = 0; run < 40; ++run) {
        const double shift = same.detectable();
        const auto by = [](double part) { return [part](int, int) { return 1 + part; }; };
        found += !compareFilms(noisy(10 + run), noisy(100 + run, 0.5, by(shift))).agrees();
        foundHalf += !compareFilms(noisy(10 + run), noisy(100 + run, 0.5, by(0.4 * shift))).agrees();
    }
    CHECK(found >= 38);
    CHECK(foundHalf <= 20);
}

TEST_CASE("agreement: what differs is found where it is") {
    const auto spot = [](int x, int y) { return x >= 16 && x < 24 && y >= 8 && y < 16 ? 1.8 : 1.0; };
    const Agreement r = compareFilms(noisy(5), noisy(6, 0.5, spot));
    CHECK(!r.agrees());
    const auto worst = r.worstBlocks(5);
    REQUIRE(!worst.empty());
    CHECK(worst[0].bounds.x0 == 16);
    CHECK(worst[0].bounds.y0 == 8);
    CHECK(worst[0].bounds.x1 == 24);
    CHECK(worst[0].difference == doctest::Approx(0.8).epsilon(0.2));
    CHECK(worst.size() == 1); // larger blocks that hold it are the same news
    CHECK(compareFilms(noisy(5), noisy(6)).worstBlocks(5).empty());
}

TEST_CASE("agreement: a block whose noise is all in one replicate is not judged") {
    // One sample of 1e4 among tens of thousands: neither its presence nor its absence means anything.
    const PixelFilm plain = noisy(7, 0.01);
    const PixelFilm firefly = film([](int x, int y, int r) { return x == 20 && y == 10 && r == 3 ? 1e4 : 1.0; });
    const Agreement r = compareFilms(plain, firefly);
    CHECK(r.unjudged == 1);
    CHECK(!r.whole.judged);
    CHECK(r.agrees());
}

TEST_CASE("agreement: pictures without noise agree to rounding and no further") {
    const auto flat = [](double v) { return film([v](int, int, int) { return v; }); };
    CHECK(compareFilms(flat(0.7), flat(0.7)).agrees());
    CHECK(compareFilms(flat(0.7), flat(0.7 * (1 + 2e-5))).agrees());
    CHECK(!compareFilms(flat(0.7), flat(0.7 * (1 + 5e-4))).agrees());
    CHECK(compareFilms(flat(0), flat(0)).agrees());
    CHECK(!compareFilms(flat(0), flat(1)).agrees());
    CHECK(!compareFilms(flat(1), flat(0)).agrees());
}

} // namespace abbe::test
