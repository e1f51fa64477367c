#include "study/equal_time.h"

#include <doctest/doctest.h>
#include <limits>

using namespace abbe;

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
