// Wall-clock time of the phases, and what processors spent.
#pragma once

#include <chrono>
#include <ctime>

namespace abbe {

class Stopwatch {
  public:
    // Seconds since the start or the last lap.
    double lap() {
        const auto now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - start_).count();
        start_ = now;
        return seconds;
    }
    // The same, and the laps stay as they are.
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

inline double secondsOf(clockid_t clock) {
    timespec t;
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

// Of all threads of this process so far, and of this thread.
inline double processSeconds() { return secondsOf(CLOCK_PROCESS_CPUTIME_ID); }
inline double threadSeconds() { return secondsOf(CLOCK_THREAD_CPUTIME_ID); }

} // namespace abbe
