// What comes after a round of a shot: again what failed, more samples, or the end.
#pragma once

#include "farm/farm_engine.h"
#include "farm/farm_plan.h"

#include <string>

namespace abbe {

// All that a new round has to do.
RoundWork workOf(const FarmPlan&, int round);

// What of a round is not done yet, and can be.
RoundWork missingOf(const FarmPlan&, const FarmFolder&, int round);

struct RoundEnd {
    enum class Kind : std::uint8_t {
        done,   // all images are there, and as good as they were to be
        limit,  // all images are there; of some the noise goal was not met by the most samples that they may have
        again,  // `work` is what is missing of the round
        more,   // `work` is a new round, of the frames that are not good enough
        failed, // some tasks cannot be done, or were tried often enough
        cancelled,
    };
    Kind kind = Kind::done;
    RoundWork work;
    std::string said; // a sentence
};

// Looks at a round whose tasks have ended, and plans what is next: changes the plan's rounds, not its file.
RoundEnd closeRound(FarmPlan&, const FarmFolder&, int round);

} // namespace abbe
