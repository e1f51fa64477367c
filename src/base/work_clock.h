// Where the time goes: looks at what every thread is at, several hundred times a second, and charges the time since
// the last look to it (docs/decisions/023-cost-report.md).
#pragma once

#include "base/work.h"

#include <array>
#include <cstdint>
#include <memory>

namespace abbe {

// Time at one kind of work. Seconds are of the clock on the wall: where several threads are at work each has its share.
struct WorkCharge {
    double seconds = 0;
    double squares = 0; // sum of the squares of what single looks added, s²: how uncertain `seconds` is
    std::uint64_t looks = 0;

    void add(const WorkCharge& c) {
        seconds += c.seconds;
        squares += c.squares;
        looks += c.looks;
    }
};

// Adds up over the runs of one render.
struct WorkReading {
    static constexpr std::size_t kCauses = kVolumeWorks + 1;

    std::array<WorkCharge, kWorks * kWorkFlags * kCauses> charges{};
    double seconds = 0; // on the wall

    static constexpr std::size_t index(std::size_t work, std::size_t flags, std::size_t cause) {
        return (work * kWorkFlags + flags) * kCauses + cause;
    }
    void add(const WorkReading& r) {
        for (std::size_t i = 0; i < charges.size(); ++i) charges[i].add(r.charges[i]);
        seconds += r.seconds;
    }
    // Of all charges for which `counts(work, flags, cause)`.
    template <typename Predicate> WorkCharge sum(Predicate counts) const {
        WorkCharge total;
        for (std::size_t work = 0; work < kWorks; ++work)
            for (std::size_t flags = 0; flags < kWorkFlags; ++flags)
                for (std::size_t cause = 0; cause < kCauses; ++cause)
                    if (counts(static_cast<Work>(work), flags, cause)) total.add(charges[index(work, flags, cause)]);
        return total;
    }
};

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
