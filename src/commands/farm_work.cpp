// One task of a shot, as a job runs it.
#include "base/path_lock.h"
#include "command_line/parser.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "commands/farm.h"
#include "farm/task_record.h"

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <system_error>
#include <unistd.h>

namespace abbe {

void addArguments(Arguments& a, FarmWorkOptions& o) {
    a.argument("folder", &o.folder, "Folder of the shot").require();
    a.argument("round", &o.round, "Number of the round").require();
    a.choice<FarmTask::Kind>(
         "kind", o.kind,
         {{"part", FarmTask::Kind::part}, {"gather", FarmTask::Kind::gather}, {"merge", FarmTask::Kind::merge}},
         "What it is")
        .require();
    a.argument("number", &o.number, "Number of the task among those").require();
    addThreads(a);
}

namespace {

constexpr double kPatienceChunks = 2; // in the time that a part should take

FarmTask taskOf(const FarmPlan& plan, const FarmWorkOptions& o) {
    if (o.round >= 1 && o.round <= static_cast<int>(plan.rounds.size())) {
        const auto all = tasksOf(plan, o.round - 1, o.kind);
        if (o.number >= 1 && o.number <= static_cast<int>(all.size()))
            return all[static_cast<std::size_t>(o.number) - 1];
    }
    throw FarmFault("E0762", fmt::format("the shot has no task {} of round {}", o.number, o.round),
                    "jobs of an older shot in this folder ask for what is not there any more: cancel them");
}

// What it says goes to the file of its events; stderr to the engine's log.
void redirectOutput(const std::string& file) {
    const int to = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (to < 0) throw std::system_error(errno, std::generic_category(), file);
    ::dup2(to, STDOUT_FILENO);
    ::close(to);
}

ExitCode execute(const std::vector<std::string>& words, const CommonOptions& common) {
    const auto result = readCommandLine(commandTable(), words);
    if (const auto* end = std::get_if<EarlyEnd>(&result)) {
        common.console.error(end->text);
        return end->code;
    }
    const auto& line = std::get<CommandLine>(result);
    return line.command->execute(line.common);
}

} // namespace

ExitCode run(const FarmWorkOptions& options, const CommonOptions& common) {
    return reportingFaults(common.console, [&] {
        const FarmFolder folder(std::filesystem::absolute(options.folder).string());
        const FarmPlan plan = folder.readPlan();
        std::filesystem::current_path(plan.folder); // where the words of its tasks were given
        const FarmTask task = taskOf(plan, options);
        // A run of it that the engine thinks is lost may go on, on a node that cannot be reached: it is waited for,
        // since it ends or dies, and then this one has nothing to do, or goes on where that one came to.
        const PathLock lock(folder.resultFile(plan, task), kPatienceChunks * plan.chunkSeconds);
        const TaskRecord record = readTaskRecord(plan, folder, task);
        if (record.done()) return ExitCode::done;
        if (plan.cancelled) return ExitCode::terminated;
        if (lock.refused())
            throw FarmFault("E0765", fmt::format("another process does {}", folder.nameOf(plan, task)),
                            "the engine thought that one lost; the shot goes on when it ends");
        std::error_code ignored;
        std::filesystem::remove(folder.resultFile(plan, task), ignored);
        redirectOutput(folder.eventsFile(plan, task));
        std::vector<std::string> words = folder.commandOf(plan, task);
        if (!record.outputThere) std::erase(words, "--resume"); // there is nothing to go on from
        const ExitCode code = execute(words, common);
        writeTaskResult(plan, folder, task, static_cast<int>(code));
        return code;
    });
}

} // namespace abbe
