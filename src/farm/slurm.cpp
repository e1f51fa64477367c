// Slurm (22.05 and later) as an engine, by its own commands: sbatch, squeue, scancel, scontrol. Parts of a round are
// job arrays; each frame has a job that merges it when its parts have ended, however they did, and looks for itself
// whether they are complete; a last job closes the round.
#include "app/console.h"
#include "base/process.h"
#include "farm/farm_engine.h"
#include "io/file.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <sstream>

namespace abbe {

namespace {

// One job or job array as sbatch gets it.
struct SlurmJob {
    std::string name;         // "r1.parts"
    std::string command;      // "farm work FOLDER 1 part"
    std::vector<int> indices; // of an array; empty: one job
    int offset = 0;           // the tasks' numbers are the indices and this
    int cores = 1;
};

// "1-4,7,9-12": as sbatch reads it.
std::string arrayText(const std::vector<int>& indices) {
    std::string text;
    for (std::size_t i = 0; i < indices.size();) {
        std::size_t j = i;
        while (j + 1 < indices.size() && indices[j + 1] == indices[j] + 1) ++j;
        text += fmt::format("{}{}", text.empty() ? "" : ",", indices[i]);
        if (j > i) text += fmt::format("-{}", indices[j]);
        i = j + 1;
    }
    return text;
}

// Everything that sbatch needs is in the script, so that it can be read and submitted by hand.
std::string scriptOf(const FarmPlan& plan, const FarmFolder& folder, const SlurmJob& job) {
    std::string s = "#!/bin/bash\n";
    const auto option = [&](const std::string& text) { s += "#SBATCH " + text + "\n"; };
    const std::string shot = std::filesystem::path(folder.path()).stem().string();
    option("--job-name=" + shellQuoted(shot + ":" + job.name));
    if (!job.indices.empty()) option("--array=" + arrayText(job.indices));
    option("--ntasks=1");
    option(fmt::format("--cpus-per-task={}", job.cores));
    option("--requeue --open-mode=append"); // a node that dies; what was said before stays
    const std::string index = job.indices.empty() ? "" : job.offset == 0 ? ".%a" : fmt::format("+{}.%a", job.offset);
    option("--output=" + shellQuoted(fmt::format("{}/log/{}{}.log", folder.path(), job.name, index)));
    for (const std::string& word : plan.sbatchWords) option(word);
    s += fmt::format("cd {} || exit 3\n", shellQuoted(plan.folder));
    s += fmt::format("exec {} {}", shellQuoted(plan.executable), job.command);
    if (!job.indices.empty()) s += fmt::format(" $((SLURM_ARRAY_TASK_ID + {}))", job.offset);
    return s + fmt::format(" -t {}\n", job.cores);
}

std::string writeScript(const FarmPlan& plan, const FarmFolder& folder, const SlurmJob& job) {
    const std::string index = job.offset == 0 ? "" : fmt::format("+{}", job.offset);
    const std::string path = fmt::format("{}/slurm/{}{}.sh", folder.path(), job.name, index);
    writeAtomically(path, scriptOf(plan, folder, job));
    return path;
}

// Task numbers of a kind, from 1, in arrays that the cluster takes: indices 1 … most each.
std::vector<SlurmJob> arraysOf(const FarmPlan& plan, const FarmFolder& folder, int round,
                               const std::vector<FarmTask>& tasks, int most) {
    const FarmTask::Kind kind = tasks[0].kind;
    std::map<int, SlurmJob> arrays; // by offset
    for (const FarmTask& task : tasks) {
        const int number = numberOf(plan, task);
        const int offset = (number - 1) / most * most;
        SlurmJob& job = arrays[offset];
        // Those that gather wait for the parts of their frame alone, so each frame has arrays of its own.
        job.name = kind == FarmTask::Kind::part
                       ? fmt::format("r{}.parts", round + 1)
                       : folder.nameOf(plan, {FarmTask::Kind::merge, round, task.frame, 1}) + ".gathers";
        job.command = fmt::format("farm work {} {} {}", shellQuoted(folder.path()), round + 1, wordOf(kind));
        job.offset = offset;
        job.cores = kind == FarmTask::Kind::part ? plan.cores : 1;
        job.indices.push_back(number - offset);
    }
    std::vector<SlurmJob> list;
    for (auto& [offset, job] : arrays) {
        std::ranges::sort(job.indices);
        list.push_back(std::move(job));
    }
    return list;
}

SlurmJob mergeJob(const FarmPlan& plan, const FarmFolder& folder, const FarmTask& task) {
    return {folder.nameOf(plan, task),
            fmt::format("farm work {} {} merge {}", shellQuoted(folder.path()), task.round + 1, numberOf(plan, task)),
            {},
            0,
            1};
}

SlurmJob closingJob(const FarmFolder& folder, int round) {
    return {fmt::format("r{}.close", round + 1),
            fmt::format("farm close {} {}", shellQuoted(folder.path()), round + 1),
            {},
            0,
            1};
}

std::string firstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string said(const ProcessEnd& end) {
    const std::string line = firstLine(end.err.empty() ? end.out : end.err);
    return line.empty() ? fmt::format("exit code {}", end.code) : line;
}

class Slurm final : public FarmEngine {
  public:
    explicit Slurm(const FarmFolder& folder) : folder_(folder) {}

    void submit(FarmPlan& plan, const RoundWork& work) override {
        const int most = largestIndex();
        std::map<std::string, std::string> jobOfTask; // "r1.0012.p3" → "17_3"
        const auto submitArrays = [&](const std::vector<FarmTask>& tasks, const std::vector<std::string>& after) {
            if (tasks.empty()) return;
            const std::vector<FarmTask> all = tasksOf(plan, work.round, tasks[0].kind);
            for (const SlurmJob& job : arraysOf(plan, folder_, work.round, tasks, most)) {
                const std::string id = submitJob(plan, job, after);
                for (const int i : job.indices)
                    jobOfTask[folder_.nameOf(plan, all[static_cast<std::size_t>(i + job.offset) - 1])] =
                        fmt::format("{}_{}", id, i);
            }
        };
        submitArrays(work.parts, {});
        // An array of its own for each frame, which can begin as soon as that frame's parts have ended.
        for (const FarmTask& merge : work.merges)
            submitArrays(ofFrame(work.gatherings, merge.frame),
                         jobsOf(plan, ofFrame(work.parts, merge.frame), jobOfTask));
        std::vector<std::string> merged;
        for (const FarmTask& merge : work.merges) {
            const auto gathered = ofFrame(work.gatherings, merge.frame);
            const auto before = jobsOf(plan, gathered.empty() ? ofFrame(work.parts, merge.frame) : gathered, jobOfTask);
            merged.push_back(submitJob(plan, mergeJob(plan, folder_, merge), before));
        }
        submitJob(plan, closingJob(folder_, work.round), merged);
    }

    std::vector<QueuedTask> queue(const FarmPlan& plan) const override {
        const ProcessEnd end = runProcess({"squeue", "--noheader", "--array", "--me", "--format=%F|%K|%j|%T|%R"});
        if (end.code != 0) throw refused("squeue", end);
        std::vector<QueuedTask> list;
        std::istringstream lines(end.out);
        for (std::string line; std::getline(lines, line);)
            if (auto task = queued(plan, line)) list.push_back(std::move(*task));
        return list;
    }

    void cancel(const FarmPlan& plan) const override {
        if (plan.jobs.empty()) return;
        std::vector<std::string> words{"scancel", "--quiet"};
        words.insert(words.end(), plan.jobs.begin(), plan.jobs.end());
        if (const ProcessEnd end = runProcess(words); end.code != 0) throw refused("scancel", end);
    }

    bool closesItself() const override { return true; }

  private:
    static FarmFault refused(const char* program, const ProcessEnd& end) {
        if (end.code == 127)
            return {
                "E0763", fmt::format("there is no Slurm here: `{}`: {}", program, end.err),
                "`--engine local` renders the shot on this machine; on a cluster submit where sbatch can be called"};
        return {"E0763", fmt::format("Slurm refuses: {}: {}", program, said(end)),
                "`abbe farm submit --print` writes what it is given, to be read and tried by hand"};
    }

    static std::vector<FarmTask> ofFrame(const std::vector<FarmTask>& tasks, int frame) {
        std::vector<FarmTask> list;
        std::ranges::copy_if(tasks, std::back_inserter(list), [&](const FarmTask& t) { return t.frame == frame; });
        return list;
    }

    std::vector<std::string> jobsOf(const FarmPlan& plan, const std::vector<FarmTask>& tasks,
                                    const std::map<std::string, std::string>& jobOfTask) const {
        std::vector<std::string> list;
        for (const FarmTask& task : tasks) list.push_back(jobOfTask.at(folder_.nameOf(plan, task)));
        return list;
    }

    // Of an array's tasks: MaxArraySize is one more.
    static int largestIndex() {
        const ProcessEnd end = runProcess({"scontrol", "show", "config"});
        if (end.code != 0) throw refused("scontrol", end);
        const auto at = end.out.find("MaxArraySize");
        const auto digits = end.out.find_first_of("0123456789", std::min(at, end.out.size()));
        int size = 1001;
        if (at != std::string::npos && digits != std::string::npos)
            std::from_chars(end.out.data() + digits, end.out.data() + end.out.size(), size);
        return std::max(1, size - 1);
    }

    std::string submitJob(FarmPlan& plan, const SlurmJob& job, const std::vector<std::string>& after) {
        std::vector<std::string> words{"sbatch", "--parsable"};
        if (!after.empty()) words.push_back(fmt::format("--dependency=afterany:{}", fmt::join(after, ":")));
        words.push_back(writeScript(plan, folder_, job));
        const ProcessEnd end = runProcess(words);
        if (end.code != 0) throw refused("sbatch", end);
        const std::string id = end.out.substr(0, end.out.find_first_of(";\n"));
        plan.jobs.push_back(id);
        if (job.offset > 0) plan.offsets[id] = job.offset;
        folder_.writePlan(plan); // so that nothing that was submitted is ever unknown
        return id;
    }

    // A line of squeue, if it is of this shot.
    std::optional<QueuedTask> queued(const FarmPlan& plan, const std::string& line) const {
        std::vector<std::string> cells;
        std::istringstream in(line);
        for (std::string cell; std::getline(in, cell, '|');) cells.push_back(cell);
        if (cells.size() < 5 || std::ranges::find(plan.jobs, cells[0]) == plan.jobs.end()) return std::nullopt;
        std::string name = cells[2].substr(cells[2].rfind(':') + 1);
        for (int r = 0; r < static_cast<int>(plan.rounds.size()); ++r)
            for (const auto kind : {FarmTask::Kind::part, FarmTask::Kind::gather})
                if (name.starts_with(fmt::format("r{}.", r + 1)) && name.ends_with(fmt::format(".{}s", wordOf(kind))))
                    name = taskName(plan, r, kind, cells);
        std::string state = cells[3];
        std::ranges::transform(state, state.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
        return QueuedTask{name, state, cells[4]};
    }

    std::string taskName(const FarmPlan& plan, int round, FarmTask::Kind kind,
                         const std::vector<std::string>& cells) const {
        int index = 0;
        std::from_chars(cells[1].data(), cells[1].data() + cells[1].size(), index);
        const std::vector<FarmTask> all = tasksOf(plan, round, kind);
        const auto number = static_cast<std::size_t>(index + offsetOf(plan, cells[0]));
        return number >= 1 && number <= all.size() ? folder_.nameOf(plan, all[number - 1]) : std::string("?");
    }

    // Arrays of more tasks than the cluster takes at once.
    static int offsetOf(const FarmPlan& plan, const std::string& job) {
        const auto found = plan.offsets.find(job);
        return found == plan.offsets.end() ? 0 : found->second;
    }

    const FarmFolder& folder_;
};

} // namespace

std::unique_ptr<FarmEngine> makeSlurm(const FarmFolder& folder) { return std::make_unique<Slurm>(folder); }

std::vector<std::string> writeSlurmScripts(const FarmFolder& folder, const FarmPlan& plan, const RoundWork& work) {
    constexpr int kUsualMost = 1000; // MaxArraySize is 1001 where nothing else is configured
    std::vector<std::string> files;
    for (const auto* tasks : {&work.parts, &work.gatherings})
        if (!tasks->empty())
            for (const SlurmJob& job : arraysOf(plan, folder, work.round, *tasks, kUsualMost))
                files.push_back(writeScript(plan, folder, job));
    for (const FarmTask& merge : work.merges) files.push_back(writeScript(plan, folder, mergeJob(plan, folder, merge)));
    files.push_back(writeScript(plan, folder, closingJob(folder, work.round)));
    return files;
}

} // namespace abbe
