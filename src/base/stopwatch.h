// Wall-clock time of the phases.
#pragma once

#include <chrono>

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

} // namespace abbe
