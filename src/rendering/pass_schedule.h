// In what portions the samples of a pixel are taken.
#pragma once

#include <algorithm>
#include <cstdint>

namespace abbe {

// The end of the pass that begins at sample `first` of a replicate. Passes end at powers of two and, from 16 samples
// on, at quarters in between: every aligned block is a net of its own, and a goal is overshot by a quarter at most. The
// schedule does not depend on the goal, so a render continued with more samples takes the same passes.
inline std::uint32_t passEnd(std::uint32_t first) {
    if (first < 2) return 2;
    std::uint32_t power = 1;
    while (power <= first / 2) power *= 2;
    return first + (power >= 16 ? power / 4 : power);
}

// The end of the pass of the whole render that sample `first` belongs to, wherever in it that is.
inline std::uint32_t endOfPassWith(std::uint32_t first) {
    std::uint32_t end = 0;
    while (end <= first) {
        const std::uint32_t next = passEnd(end);
        if (next < end) return 0xffffffff; // beyond 32 bits
        end = next;
    }
    return end;
}

} // namespace abbe
