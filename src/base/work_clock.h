// Where the time goes: looks at what every thread is at, several hundred times a second, and charges the time since
// the last look to it (docs/decisions/023-bill.md).
#pragma once

#include "base/work_reading.h"

#include <memory>

namespace abbe {

// When to look next, in s from now, `elapsed` s after the start: 2 ms in the mean, after ten seconds rarer, at most
// 10 ms. Spread by the golden ratio, so that no work with a period of its own is always met at the same place; `spread`
// belongs to the caller and begins at 0.
double untilNextLook(double elapsed, double& spread);

// Looks on from a thread of its own, from construction to destruction. Of several at a time each sees the same.
class WorkClock {
  public:
    // The calling thread is the one whose work for the program as a whole has all the time while it lasts; it must
    // outlive the clock. Of the rest `threads` (at least 1) share the time, those without work included. If the system
    // has no thread for it, it looks only when read.
    explicit WorkClock(int threads);
    ~WorkClock();
    WorkClock(const WorkClock&) = delete;
    WorkClock& operator=(const WorkClock&) = delete;

    // Up to now. Of any thread.
    WorkReading read();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace abbe
