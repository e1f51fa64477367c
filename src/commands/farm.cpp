#include "commands/farm.h"

#include "app/json.h"
#include "base/path_lock.h"
#include "command_line/parser.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "farm/farm_engine.h"
#include "farm/rounds.h"
#include "farm/shot_status.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <thread>

namespace abbe {

const char* const kFarmHelp = R"(Renders a shot on many machines, with Slurm or as processes of this one.

Examples:
  abbe farm submit shot.scene --samples 4096                 shot.exr, by jobs of about ten minutes
  abbe farm submit shot.scene --frames 1-240 --noise 0.5% -o shot.####.exr
  abbe farm watch shot.farm                                  a table of frames and parts, until all is done
  abbe farm picture shot.farm -o look.exr                    what there is so far
  abbe farm resume shot.farm                                 what failed or was cancelled, again)";

namespace {

constexpr const char* kSubmitHelp = R"(Plans a shot and hands it to the engine: parts of about ten minutes, then merges.

Examples:
  abbe farm submit shot.scene --samples 4096
  abbe farm submit shot.scene --frames 1-240x2 -o shot.####.exr --sbatch=--partition=night
  abbe farm submit shot.scene --noise 0.5%                   rounds, until that is met
  abbe farm submit shot.scene --engine local --at-once 4     processes of this machine
  abbe farm submit shot.scene --print                        the sbatch scripts, for reading)";

constexpr const char* kStatusHelp = R"(Tells how a shot stands: frames, parts, samples and noise so far, time left.

Examples:
  abbe farm status shot.farm
  abbe farm status shot.farm --json)";

constexpr const char* kWatchHelp = R"(Shows the status of a shot until it is over.

Examples:
  abbe farm watch shot.farm)";

constexpr const char* kCancelHelp = R"(Ends all tasks of a shot; what they have is saved, and `resume` goes on with it.

Examples:
  abbe farm cancel shot.farm)";

constexpr const char* kFarmResumeHelp =
    R"(Submits again what is missing of a shot: what failed, was cancelled or got lost.

Examples:
  abbe farm resume shot.farm)";

constexpr const char* kPictureHelp = R"(Makes a picture of what there is of a frame, at any moment.

Examples:
  abbe farm picture shot.farm -o look.exr
  abbe farm picture shot.farm --frame 12 -o look.exr)";

constexpr const char* kWorkHelp = R"(Does one task of a shot; the engine's jobs call it.

Examples:
  abbe farm work shot.farm 1 part 3)";

constexpr const char* kCloseHelp =
    R"(Looks at a round of a shot whose tasks have ended, and submits what is next; a job of the engine calls it.

Examples:
  abbe farm close shot.farm 1)";

constexpr CommandEntry kFarmActions[] = {{"submit", "", kSubmitHelp, makeCommand<FarmSubmitOptions>},
                                         {"status", "", kStatusHelp, makeCommand<FarmStatusOptions>},
                                         {"watch", "", kWatchHelp, makeCommand<FarmWatchOptions>},
                                         {"cancel", "", kCancelHelp, makeCommand<FarmCancelOptions>},
                                         {"resume", "", kFarmResumeHelp, makeCommand<FarmResumeOptions>},
                                         {"picture", "", kPictureHelp, makeCommand<FarmPictureOptions>},
                                         {"work", "", kWorkHelp, makeCommand<FarmWorkOptions>},
                                         {"close", "", kCloseHelp, makeCommand<FarmCloseOptions>}};

constexpr double kPlanPatience = 120; // s, for another process that changes the plan

void lockPlan(const PathLock& lock, const FarmFolder& folder) {
    if (lock.refused())
        throw FarmFault("E0765", fmt::format("another process changes the plan of `{}`", folder.path()),
                        "wait for its end, or look for one that hangs");
}

ShotStatus statusNow(const FarmPlan& plan, const FarmFolder& folder, TaskRecords& records) {
    const auto engine = makeEngine(plan.engine, folder);
    return statusOf(plan, folder, records, plan.outcome ? std::vector<QueuedTask>() : engine->queue(plan));
}

ExitCode codeOf(std::optional<ShotOutcome> outcome) {
    if (outcome == ShotOutcome::failed) return ExitCode::faulty;
    return outcome == ShotOutcome::limit ? ExitCode::threshold : ExitCode::done;
}

void folderArgument(Arguments& a, std::string& folder) {
    a.argument("folder", &folder, "Folder of the shot").require();
}

} // namespace

std::span<const CommandEntry> farmActions() { return kFarmActions; }

ExitCode reportFarmFault(const FarmFault& fault, const Console& console) {
    console.report(fault);
    return fault.code == "E0763" ? ExitCode::system : ExitCode::faulty;
}

ExitCode goOn(FarmPlan& plan, const FarmFolder& folder, int round, const CommonOptions& common) {
    const auto engine = makeEngine(plan.engine, folder);
    for (;;) {
        const RoundEnd end = closeRound(plan, folder, round);
        if (!common.json) common.console.line(fmt::format("round {}: {}", round + 1, end.said));
        if (end.outcome) {
            if (end.outcome == ShotOutcome::cancelled) return ExitCode::done; // which is in a file of its own
            plan.outcome = end.outcome;
            plan.said = end.said;
            folder.writePlan(plan);
            return codeOf(end.outcome);
        }
        round = end.work.round;
        folder.writePlan(plan);
        engine->submit(plan, end.work);
        if (engine->closesItself()) return ExitCode::done;
        if (engine->signal() != 0) return static_cast<ExitCode>(128 + engine->signal());
        plan.cancelled = folder.isCancelled();
    }
}

void addArguments(Arguments& a, FarmStatusOptions& o) {
    folderArgument(a, o.folder);
    addJson(a);
}

void addArguments(Arguments& a, FarmWatchOptions& o) {
    folderArgument(a, o.folder);
    a.read("--every", "TIME", o.every, "a time such as 5s", readTime, "Look that often, 2s");
    addJson(a, "A line of JSON each time");
}

void addArguments(Arguments& a, FarmCancelOptions& o) { folderArgument(a, o.folder); }
void addArguments(Arguments& a, FarmResumeOptions& o) { folderArgument(a, o.folder); }

void addArguments(Arguments& a, FarmPictureOptions& o) {
    folderArgument(a, o.folder);
    a.value("-o,--output", "FILE", &o.output, "Image to write (EXR); a PNG is beside it").require();
    a.value("--frame", "N", &o.frame, "Frame of an animation; without it the first one that has begun");
}

ExitCode run(const FarmStatusOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(options.folder);
        const FarmPlan plan = folder.readPlan();
        TaskRecords records(folder);
        const ShotStatus status = statusNow(plan, folder, records);
        common.console.data(common.json ? statusJson(plan, folder, status).text(true) + "\n"
                                        : statusTable(plan, folder, status));
        return codeOf(status.outcome);
    });
}

ExitCode run(const FarmWatchOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(options.folder);
        std::size_t lines = 0;
        TaskRecords records(folder);
        for (;;) {
            const FarmPlan plan = folder.readPlan();
            records.forgetUndone();
            const ShotStatus status = statusNow(plan, folder, records);
            const std::string table = statusTable(plan, folder, status);
            if (common.json) {
                common.console.data(statusJson(plan, folder, status).text() + "\n");
            } else {
                // The table before is written over on a terminal.
                if (lines > 0 && common.console.interactive())
                    common.console.data(fmt::format("\033[{}A\033[J", lines));
                common.console.data(table);
            }
            lines = static_cast<std::size_t>(std::ranges::count(table, '\n'));
            if (status.outcome) return codeOf(status.outcome);
            std::this_thread::sleep_for(std::chrono::duration<double>(options.every));
        }
    });
}

ExitCode run(const FarmCancelOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(options.folder);
        const FarmPlan plan = folder.readPlan();
        folder.setCancelled(true);
        makeEngine(plan.engine, folder)->cancel(plan);
        common.console.line(
            fmt::format("cancelled; `abbe farm resume {}` goes on with what there is", shellQuoted(options.folder)));
        return ExitCode::done;
    });
}

ExitCode run(const FarmResumeOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(options.folder);
        const PathLock lock(folder.planFile(), 1);
        lockPlan(lock, folder);
        FarmPlan plan = folder.readPlan();
        if (const auto waiting = makeEngine(plan.engine, folder)->queue(plan); !waiting.empty() && !plan.cancelled)
            throw FarmFault(
                "E0765",
                fmt::format("`{}` goes on by itself: {} tasks are in the queue", folder.path(), waiting.size()),
                fmt::format("`abbe farm cancel {}` ends them", folder.path()));
        folder.setCancelled(false);
        plan.cancelled = false;
        plan.outcome.reset();
        plan.said.clear();
        plan.rounds.back().tries = -1; // all over again
        folder.writePlan(plan);
        return goOn(plan, folder, static_cast<int>(plan.rounds.size()) - 1, common);
    });
}

ExitCode run(const FarmPictureOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(options.folder);
        const FarmPlan plan = folder.readPlan();
        std::error_code error;
        for (const int frame : plan.rounds[0].frames) {
            if (options.frame && frame != *options.frame) continue;
            std::vector<std::string> words{"merge", "--so-far", "-o", options.output};
            words.insert(words.end(), plan.mergeWords.begin(), plan.mergeWords.end());
            std::erase_if(words, [](const std::string& w) { return w.starts_with("--png"); });
            words.push_back("--");
            const std::size_t before = words.size();
            for (int r = 0; r < static_cast<int>(plan.rounds.size()); ++r)
                for (const FarmTask& task : tasksOf(plan, r, FarmTask::Kind::part))
                    if (task.frame == frame && std::filesystem::exists(folder.outputOf(plan, task), error))
                        words.push_back(folder.outputOf(plan, task));
            if (words.size() == before) continue;
            const auto line = readCommandLine(commandTable(), words);
            return std::get<CommandLine>(line).command->execute(common);
        }
        throw FarmFault("E0766", "there is nothing to see yet: no part has saved anything",
                        "parts are saved every 25 s; `abbe farm status` tells which have begun");
    });
}

void addArguments(Arguments& a, FarmCloseOptions& o) {
    folderArgument(a, o.folder);
    a.argument("round", &o.round, "Number of the round").require();
    addThreads(a);
}

ExitCode run(const FarmCloseOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(options.folder);
        const PathLock lock(folder.planFile(), kPlanPatience);
        lockPlan(lock, folder);
        FarmPlan plan = folder.readPlan();
        if (options.round != static_cast<int>(plan.rounds.size())) return ExitCode::done; // closed before
        return goOn(plan, folder, options.round - 1, common);
    });
}

} // namespace abbe
