// What a study is asked for.
#pragma once

#include "study/study_variant.h"

#include <cstdint>
#include <vector>

namespace abbe {

struct StudyPlan {
    ChosenVariants chosen;
    std::uint32_t samples = 64; // per pixel, of the last rung at most
    int seeds = 8;              // replicates of each curve
    std::uint64_t seed = 0;     // those of the curves follow it
    double timeLimit = 0;       // s of this run of the study; 0: none

    // The samples per pixel of the rungs: each is twice the one before, the first has about four.
    // Requires replicates >= 1.
    static std::vector<std::uint32_t> ladder(std::uint32_t samples, int replicates);
    // The first replicate is 1. A picture of a curve is that of `abbe render --seed` with it.
    std::uint64_t seedOf(int replicate) const { return seed + static_cast<std::uint64_t>(replicate); }
    // Far from those of the curves; half 0 or 1.
    std::uint64_t referenceSeed(int half) const;
};

} // namespace abbe
