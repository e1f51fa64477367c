#pragma once

#include <ctime>

namespace abbe::test {

// Seconds that this thread computes for `f`, however busy the machine is; waiting counts nothing.
template <typename F> double cpuSecondsOf(const F& f) {
    const auto now = [] {
        timespec t{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    const double begin = now();
    f();
    return now() - begin;
}

} // namespace abbe::test
