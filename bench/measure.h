// What the benchmarks of geometry measure with.
#pragma once

#include "math/vec.h"

#include <fstream>
#include <random>
#include <time.h>
#include <unistd.h>

namespace abbe {

inline std::mt19937 engine(1);

inline float uniform() { return std::uniform_real_distribution<float>(0, 1)(engine); }

inline Vec3 inBall() {
    for (;;)
        if (const Vec3 v = Vec3(uniform(), uniform(), uniform()) * 2 - Vec3(1, 1, 1); lengthSquared(v) < 1) return v;
}

// Of this thread, or of all of them: the machine may have other things to do.
inline double seconds(clockid_t clock) {
    timespec t;
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double residentBytes() {
    std::size_t total = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

} // namespace abbe
