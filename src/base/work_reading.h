// What a WorkClock saw.
#pragma once

#include "base/work.h"

#include <array>
#include <cstdint>

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

} // namespace abbe
