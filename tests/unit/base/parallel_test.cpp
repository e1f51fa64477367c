// The parallel loop: every index once, exceptions reach the caller, denormals are flushed in every worker.
#include "base/parallel.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <doctest/doctest.h>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace abbe;

TEST_CASE("parallel loop: every index once") {
    std::vector<std::atomic<int>> met(10'007);
    parallelFor(met.size(), [&](std::size_t i) { ++met[i]; });
    int wrong = 0;
    for (const auto& m : met) wrong += m != 1;
    CHECK(wrong == 0);
    parallelFor(0, [](std::size_t) { FAIL("an empty loop has no body"); });
}

TEST_CASE("parallel loop: an exception reaches the caller") {
    CHECK_THROWS_AS(parallelFor(100,
                                [](std::size_t i) {
                                    if (i == 57) throw std::runtime_error("57");
                                }),
                    std::runtime_error);
}

// docs/hard_cases.md, case 59: a thread without the flags would compute with denormals, a hundred times slower.
TEST_CASE("parallel loop: denormals are flushed in every worker, new ones too") {
    std::mutex mutex;
    std::set<std::thread::id> threads;
    std::atomic<int> survivors = 0;
    const auto check = [&] {
        parallelFor(64, [&](std::size_t) {
            const volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
            const volatile float denormal = std::numeric_limits<float>::denorm_min(), large = 1e30f;
            if (smallest * half != 0) ++survivors;                     // flush to zero
            if (denormal * large != 0) ++survivors;                    // denormals are zero
            std::this_thread::sleep_for(std::chrono::milliseconds(1)); // so that more than one thread takes part
            const std::lock_guard lock(mutex);
            threads.insert(std::this_thread::get_id());
        });
    };
    check();
    std::thread(check).join(); // a caller that has never run a loop
    CHECK(survivors == 0);
    CHECK(threads.size() >= 2);
}

TEST_CASE("parallel loop: as many threads as it was told, be there as many cores or not") {
    constexpr int kThreads = 5;
    setThreadCount(kThreads);
    std::mutex mutex;
    std::condition_variable changed;
    int inside = 0;
    bool late = false;
    parallelFor(kThreads, [&](std::size_t) { // each of them waits for all others
        std::unique_lock lock(mutex);
        ++inside;
        changed.notify_all();
        if (!changed.wait_for(lock, std::chrono::seconds(60), [&] { return inside == kThreads || late; })) late = true;
        changed.notify_all();
    });
    setThreadCount(0);
    CHECK_FALSE(late);
    const volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
    CHECK(smallest * half != 0); // the caller's own control register is as it was
}

// Bodies of render loops hold locks, which a thread that took up another one would wait for itself to give back.
TEST_CASE("parallel parts: idle workers take part, and who waits for them takes up nothing else") {
    constexpr int kThreads = 4;
    setThreadCount(kThreads);
    static thread_local bool within = false;
    std::atomic<int> nested = 0, parts = 0;
    std::mutex mutex;
    std::set<std::thread::id> threads; // in the parts of the last body
    parallelFor(40, [&](std::size_t i) {
        if (within) ++nested;
        within = true;
        parallelParts(8, [&](std::size_t) {
            std::this_thread::sleep_for(std::chrono::milliseconds(i == 39 ? 20 : 1));
            ++parts;
            const std::lock_guard lock(mutex);
            if (i == 39) threads.insert(std::this_thread::get_id());
        });
        within = false;
    });
    setThreadCount(0);
    CHECK(nested == 0);
    CHECK(parts == 40 * 8);
    CHECK(threads.size() >= 2);
}
