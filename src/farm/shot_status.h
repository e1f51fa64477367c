// How a shot stands: frame by frame, and as a whole.
#pragma once

#include "app/json.h"
#include "farm/farm_engine.h"
#include "farm/farm_plan.h"
#include "farm/task_record.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct FrameStatus {
    int frame = 0;
    int parts = 0, done = 0, running = 0, waiting = 0, failed = 0; // of all rounds
    int requeued = 0;                                              // runs that were taken up again
    double samples = 0;                                            // per pixel so far
    double noise = 0; // relative error of these, from what the parts say of themselves; 0: unknown
    bool merged = false;
};

struct ShotStatus {
    std::optional<ShotOutcome> outcome; // if it is over
    bool idle = false;                  // nothing runs, and nothing waits for its turn
    std::string said;                   // why it is over, or waits
    std::vector<FrameStatus> frames;
    double fraction = 0;    // of the samples of all rounds that are planned
    double secondsLeft = 0; // with as many tasks at once as now; 0: unknown
    int running = 0;        // tasks
};

// `queue`: of the engine.
ShotStatus statusOf(const FarmPlan&, const FarmFolder&, TaskRecords&, const std::vector<QueuedTask>& queue);

std::string statusTable(const FarmPlan&, const FarmFolder&, const ShotStatus&);
Json statusJson(const FarmPlan&, const FarmFolder&, const ShotStatus&);

} // namespace abbe
