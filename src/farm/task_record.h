// What a task of a shot said and left behind: how far it came, and how it ended.
#pragma once

#include "app/program_end.h"
#include "farm/farm_plan.h"

#include <optional>
#include <string>
#include <unordered_map>

namespace abbe {

struct TaskRecord {
    int starts = 0;           // how often it began: once more than it was taken up again
    double fraction = 0;      // of its samples, 0 … 1, of the run that spoke last
    double coreSeconds = 0;   // of that run
    double noise = 0;         // relative error of its samples; 0: unknown
    std::optional<int> exit;  // how the last run ended, if it could say so
    std::string fault;        // its last error: "error[E0663]: …"
    bool outputThere = false; // its file
    // Whether it need not be run again.
    bool done() const { return exit == 0 && outputThere; }
    // Whether running it again would end the same way: the scene is wrong, or the command, or a part is of another
    // shot.
    bool hopeless() const {
        return exit && (*exit == static_cast<int>(ExitCode::faulty) || *exit == static_cast<int>(ExitCode::usage));
    }
};

// Of files that may be written at this moment; nothing is there yet before the task begins.
TaskRecord readTaskRecord(const FarmPlan&, const FarmFolder&, const FarmTask&);

// The records of a shot's tasks, each read when it is asked for first.
class TaskRecords {
  public:
    explicit TaskRecords(const FarmFolder& folder) : folder_(folder) {}
    // Until the next forgetUndone(). Of one shot's plan, which may grow meanwhile.
    const TaskRecord& of(const FarmPlan&, const FarmTask&);
    // Whoever looks again later reads only what was not done, or whose file is gone.
    void forgetUndone();

  private:
    struct Known {
        TaskRecord record;
        std::string output;
    };
    const FarmFolder& folder_;
    std::unordered_map<std::string, Known> known_; // by the tasks' names
};

// How a run of it ended. Throws IoError.
void writeTaskResult(const FarmPlan&, const FarmFolder&, const FarmTask&, int exit);

} // namespace abbe
