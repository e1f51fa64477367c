#include "study/study_plan.h"

#include "base/check.h"
#include "math/hash.h"

namespace abbe {

std::vector<std::uint32_t> StudyPlan::ladder(std::uint32_t samples, int replicates) {
    ABBE_CHECK(replicates >= 1);
    const auto r = static_cast<std::uint64_t>(replicates);
    std::uint64_t each = 1; // samples of a replicate
    while (each * r < 4) each *= 2;
    std::vector<std::uint32_t> rungs;
    for (; each * r <= samples; each *= 2) rungs.push_back(static_cast<std::uint32_t>(each * r));
    return rungs;
}

std::uint64_t StudyPlan::referenceSeed(int half) const {
    constexpr std::uint64_t kReference = 0x7265666572; // "refer"
    constexpr std::uint64_t kLargest = (std::uint64_t(1) << 53) - 1;
    return combine64(combine64(kReference, seed), static_cast<std::uint64_t>(half)) & kLargest;
}

} // namespace abbe
