// `abbe farm`: a shot on many machines. What each action is asked to do; docs/farm.md.
#pragma once

#include "command_line/command.h"
#include "farm/farm_plan.h"
#include "render_run/render_options.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

struct FarmSubmitOptions {
    RenderOptions render; // of a render, as far as it can be divided
    std::string folder;   // empty: the image's name with `.farm`
    FarmEngineKind engine = FarmEngineKind::slurm;
    double chunk = 600;       // s
    std::optional<int> parts; // of each frame, instead
    int atOnce = 1;
    int tries = 2;
    std::vector<std::string> sbatch;
    bool print = false; // scripts alone

    static bool makesFiles() { return true; }
};

struct FarmStatusOptions {
    std::string folder;
};
struct FarmWatchOptions {
    std::string folder;
    double every = 2; // s
};
struct FarmCancelOptions {
    std::string folder;
};
struct FarmResumeOptions {
    std::string folder;
    static bool makesFiles() { return true; }
};
struct FarmPictureOptions {
    std::string folder, output;
    std::optional<int> frame; // without it the first that has a part
    static bool makesFiles() { return true; }
};

// What jobs run.
struct FarmWorkOptions {
    std::string folder;
    int round = 1;
    FarmTask::Kind kind = FarmTask::Kind::part;
    int number = 1; // of its kind in the round
};
struct FarmCloseOptions {
    std::string folder;
    int round = 1;
};

extern const char* const kFarmHelp;
std::span<const CommandEntry> farmActions();

void addArguments(Arguments&, FarmSubmitOptions&);
void addArguments(Arguments&, FarmStatusOptions&);
void addArguments(Arguments&, FarmWatchOptions&);
void addArguments(Arguments&, FarmCancelOptions&);
void addArguments(Arguments&, FarmResumeOptions&);
void addArguments(Arguments&, FarmPictureOptions&);
void addArguments(Arguments&, FarmWorkOptions&);
void addArguments(Arguments&, FarmCloseOptions&);
ExitCode run(const FarmSubmitOptions&, const CommonOptions&);
ExitCode run(const FarmStatusOptions&, const CommonOptions&);
ExitCode run(const FarmWatchOptions&, const CommonOptions&);
ExitCode run(const FarmCancelOptions&, const CommonOptions&);
ExitCode run(const FarmResumeOptions&, const CommonOptions&);
ExitCode run(const FarmPictureOptions&, const CommonOptions&);
ExitCode run(const FarmWorkOptions&, const CommonOptions&);
ExitCode run(const FarmCloseOptions&, const CommonOptions&);

// Shared by the actions.

// A fault as a diagnostic; its exit code.
ExitCode reportFarmFault(const FarmFault&, const Console&);

// What the action returns, or the code of the fault that it met.
template <typename Action> ExitCode reportingFaults(const Console& console, const Action& action) {
    try {
        return action();
    } catch (const FarmFault& fault) {
        return reportFarmFault(fault, console);
    }
}

// Runs rounds from this one on, as far as the engine lets this process do it: Slurm's jobs go on by themselves. Says
// what becomes of them. Requires the lock of the plan.
ExitCode goOn(FarmPlan&, const FarmFolder&, int round, const CommonOptions&);

} // namespace abbe
