// What runs the tasks of a shot: Slurm, or processes of this machine.
#pragma once

#include "farm/farm_plan.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// What is to be run of one round: parts, then what gathers and merges them, then what closes the round.
struct RoundWork {
    int round = 0; // index
    std::vector<FarmTask> parts, gatherings, merges;
    bool empty() const { return parts.empty() && gatherings.empty() && merges.empty(); }
};

// A task in the queue of an engine.
struct QueuedTask {
    std::string name;  // FarmFolder::nameOf()
    std::string state; // "running", "pending", and Slurm's others in lower case
    std::string where; // node, or why it waits
};

// All throw FarmFault when the engine refuses.
class FarmEngine {
  public:
    virtual ~FarmEngine() = default;
    // Hands the work over; what is submitted is noted in the plan. Slurm: at once. Local: when it was done, or ended by
    // a signal.
    virtual void submit(FarmPlan&, const RoundWork&) = 0;
    // What is known of tasks that have not ended.
    virtual std::vector<QueuedTask> queue(const FarmPlan&) const = 0;
    // Ends all tasks; those that render save what they have.
    virtual void cancel(const FarmPlan&) const = 0;
    // Whether closeRound() is called by a job of its own.
    virtual bool closesItself() const = 0;
    // The signal that ended submit(), or 0.
    virtual int signal() const { return 0; }
};

std::unique_ptr<FarmEngine> makeSlurm(const FarmFolder&);
std::unique_ptr<FarmEngine> makeLocalEngine(const FarmFolder&);
std::unique_ptr<FarmEngine> makeEngine(FarmEngineKind, const FarmFolder&);

// The scripts that Slurm would be given, for reading and for other engines. Written to FOLDER/slurm.
std::vector<std::string> writeSlurmScripts(const FarmFolder&, const FarmPlan&, const RoundWork&);

} // namespace abbe
