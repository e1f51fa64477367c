// The clock that looks on: known work of known length is charged to what it is, shares add up to the time on the wall,
// and periodic work is not met at the same place again and again.
#include "base/parallel.h"
#include "base/work_clock.h"

#include <chrono>
#include <cmath>
#include <doctest/doctest.h>
#include <thread>

namespace abbe::test {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Busy for so long; returns how long it really was.
double work(Work what, double seconds) {
    const WorkScope scope(what);
    const auto start = Clock::now();
    while (secondsSince(start) < seconds) {
    }
    return secondsSince(start);
}

double charged(const WorkReading& r, Work what) {
    return r.sum([=](Work w, std::size_t, std::size_t) { return w == what; }).seconds;
}
double everything(const WorkReading& r) {
    return r.sum([](Work, std::size_t, std::size_t) { return true; }).seconds;
}

} // namespace

TEST_CASE("clock of work: what a thread is at has the time, and all adds up") {
    const auto start = Clock::now();
    WorkClock clock(1);
    double surface = 0, lights = 0;
    for (int i = 0; i < 60; ++i) {
        surface += work(Work::surface, 0.004);
        lights += work(Work::lights, 0.012);
    }
    const WorkReading reading = clock.read();
    const double wall = secondsSince(start);
    CHECK(reading.seconds == doctest::Approx(wall).epsilon(0.02));
    CHECK(everything(reading) == doctest::Approx(reading.seconds).epsilon(1e-9));
    // Three standard errors of 480 looks.
    CHECK(charged(reading, Work::surface) == doctest::Approx(surface).epsilon(0.25));
    CHECK(charged(reading, Work::lights) == doctest::Approx(lights).epsilon(0.1));
    CHECK(charged(reading, Work::film) == 0);
    CHECK(charged(reading, Work::tracing) == 0);
}

TEST_CASE("clock of work: work with the period of the looks is not met at one place") {
    for (const double period : {0.0005, 0.001, 0.002, 0.004}) {
        double at = 0.0003, spread = 0;
        int early = 0;
        for (int i = 0; i < 2000; ++i) {
            at += untilNextLook(1, spread);
            early += std::fmod(at, period) < period / 2;
        }
        CAPTURE(period);
        CHECK(early / 2000. == doctest::Approx(0.5).epsilon(0.1));
        CHECK((at - 0.0003) / 2000 == doctest::Approx(0.002).epsilon(0.01));
    }
    double spread = 0;
    CHECK(untilNextLook(1e6, spread) <= 0.015);
}

TEST_CASE("clock of work: threads share the time, with those that have nothing to do") {
    WorkClock clock(2);
    double busy = 0;
    std::thread other([&] {
        showWork();
        busy = work(Work::film, 0.3);
    });
    other.join();
    const WorkReading reading = clock.read();
    CHECK(everything(reading) == doctest::Approx(reading.seconds).epsilon(1e-9));
    CHECK(charged(reading, Work::film) == doctest::Approx(busy / 2).epsilon(0.1));
    CHECK(charged(reading, Work::none) == doctest::Approx(reading.seconds - busy / 2).epsilon(0.1));
    // The thread is gone, and is not looked at any more.
    work(Work::lights, 0.05);
    CHECK(charged(clock.read(), Work::film) == charged(reading, Work::film));
}

TEST_CASE("clock of work: work for the program as a whole has all the time, whoever helps") {
    WorkClock clock(2);
    std::thread other([&] {
        showWork();
        work(Work::film, 0.2);
    });
    const double building = work(Work::building, 0.2);
    other.join();
    const WorkReading reading = clock.read();
    CHECK(charged(reading, Work::building) == doctest::Approx(building).epsilon(0.05));
    CHECK(charged(reading, Work::film) < 0.1 * building);
}

TEST_CASE("clock of work: circumstances are kept apart, and readings add up") {
    WorkReading all;
    for (int run = 0; run < 2; ++run) {
        WorkClock clock(1);
        addWorkFlag(WorkFlag::heroOnly);
        setWorkCause(3);
        work(Work::tracing, 0.1);
        removeWorkFlag(WorkFlag::heroOnly);
        setWorkCause(0);
        work(Work::tracing, 0.1);
        all.add(clock.read());
    }
    const auto flagged = [](Work w, std::size_t flags, std::size_t cause) {
        return w == Work::tracing && flags == static_cast<std::size_t>(WorkFlag::heroOnly) && cause == 3;
    };
    CHECK(all.sum(flagged).seconds == doctest::Approx(0.2).epsilon(0.1));
    CHECK(all.seconds == doctest::Approx(0.4).epsilon(0.1));
    CHECK(all.sum(flagged).looks > 40);
}

TEST_CASE("scopes of work: what was before comes back, and costs of loops end with them") {
    CHECK(workState.work.load() == 0);
    {
        const WorkScope outer(Work::surface);
        {
            const WorkScope inner(Work::tracing);
            CHECK(workState.work.load() == static_cast<std::uint8_t>(Work::tracing));
        }
        CHECK(workState.work.load() == static_cast<std::uint8_t>(Work::surface));
    }
    CHECK(workState.work.load() == 0);
    CHECK(volumeRow(3) == 3);
    CHECK(volumeRow(1000) == kVolumeWorks - 1);
}

} // namespace abbe::test
