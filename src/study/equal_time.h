// Where ladders of samples end, so that curves have equal time and not equal samples.
#pragma once

#include "study/seed_run.h"

#include <algorithm>

namespace abbe {

// What a ladder will have taken with one more rung, which has twice the samples: of a part that goes with them and one
// that does not, as that of a denoiser. s; requires two rungs.
inline double secondsWithNextRung(const std::vector<RungRun>& rungs) {
    const double last = rungs.back().seconds, before = rungs[rungs.size() - 2].seconds;
    return last + 2 * std::max(0.0, last - before);
}

// Whether it is taken, beside a main curve of so many seconds. The last rung should end near that time: where a rung
// doubles the time, between 0.8 and 1.6 of it. Two rungs are taken in any case, and whatever nobody waits for.
inline bool worthAnotherRung(const std::vector<RungRun>& rungs, double mainSeconds) {
    constexpr double kMostOfMain = 1.6, kNoticed = 0.25; // s
    return rungs.size() < 2 || secondsWithNextRung(rungs) <= std::max(kNoticed, kMostOfMain * mainSeconds);
}

} // namespace abbe
