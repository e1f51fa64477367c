// The parallel loop: every index once, exceptions reach the caller, denormals are flushed in every worker.
#include "base/parallel.h"

#include <atomic>
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
