// What comes after a round of a shot: again what failed, more samples, or the end.
#pragma once

#include "farm/farm_engine.h"
#include "farm/farm_plan.h"

#include <optional>
#include <string>

namespace abbe {

// All that a new round has to do.
RoundWork workOf(const FarmPlan&, int round);

struct RoundEnd {
    std::optional<ShotOutcome> outcome; // of the shot; nothing: there is more to do
    RoundWork work;                     // what is missing of the round, or a new one, of the frames that need it
    std::string said;                   // a sentence
};

// Looks at a round whose tasks have ended, and plans what is next: changes the plan's rounds, not its file.
RoundEnd closeRound(FarmPlan&, const FarmFolder&, int round);

} // namespace abbe
