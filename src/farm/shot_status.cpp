#include "farm/shot_status.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <unordered_map>

namespace abbe {

namespace {

constexpr std::size_t kMostRows = 40;
// A render says something every five seconds: one that was silent for longer does not run on this machine any more.
constexpr double kSilence = 20; // s

using Queue = std::unordered_map<std::string, const QueuedTask*>;

double silenceOf(const std::string& file) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(file, error);
    if (error) return kSilence;
    return std::chrono::duration<double>(std::filesystem::file_time_type::clock::now() - written).count();
}

enum class TaskState : std::uint8_t { done, running, waiting, failed };

TaskState stateOf(const FarmPlan& plan, const FarmFolder& folder, const FarmTask& task, const TaskRecord& record,
                  const Queue& queue) {
    if (record.done()) return TaskState::done;
    if (const auto found = queue.find(folder.nameOf(plan, task)); found != queue.end())
        return found->second->state == "running" || found->second->state == "completing" ? TaskState::running
                                                                                         : TaskState::waiting;
    if (plan.engine == FarmEngineKind::local && record.starts > 0 && !record.exit &&
        silenceOf(folder.eventsFile(plan, task)) < kSilence)
        return TaskState::running;
    if (record.exit || (record.starts > 0 && plan.engine == FarmEngineKind::slurm)) return TaskState::failed;
    return TaskState::waiting;
}

// Errors of independent samples: sums of n have the error of their mean, √Σ(n e)² / Σn.
struct NoiseSum {
    void add(double samples, double noise) {
        if (samples <= 0) return;
        all += samples;
        if (noise <= 0) return;
        squares += samples * samples * noise * noise;
        known += samples;
    }
    double noise() const { return known > 0 ? std::sqrt(squares) / known * std::sqrt(known / all) : 0; }
    double all = 0, known = 0, squares = 0;
};

const char* stateOf(const ShotStatus& status) {
    return status.outcome ? wordOf(*status.outcome) : status.idle ? "idle" : "going";
}

std::string timeText(double seconds) {
    const auto s = static_cast<long>(std::lround(seconds));
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
    return fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

} // namespace

ShotStatus statusOf(const FarmPlan& plan, const FarmFolder& folder, TaskRecords& records,
                    const std::vector<QueuedTask>& queued) {
    ShotStatus status;
    Queue queue;
    for (const QueuedTask& task : queued) queue.emplace(task.name, &task);
    double left = 0, all = 0;
    for (const int frame : plan.rounds[0].frames) {
        FrameStatus f;
        f.frame = frame;
        NoiseSum noise;
        for (int r = 0; r < static_cast<int>(plan.rounds.size()); ++r) {
            const FarmRound& round = plan.rounds[static_cast<std::size_t>(r)];
            if (std::ranges::find(round.frames, frame) == round.frames.end()) continue;
            const double samples = static_cast<double>(round.to - round.from) / round.parts;
            for (int piece = 1; piece <= round.parts; ++piece) {
                const FarmTask task{FarmTask::Kind::part, r, frame, piece};
                const TaskRecord& record = records.of(plan, task);
                const TaskState state = stateOf(plan, folder, task, record, queue);
                ++f.parts;
                f.done += state == TaskState::done;
                f.running += state == TaskState::running;
                f.waiting += state == TaskState::waiting;
                f.failed += state == TaskState::failed;
                f.requeued += std::max(0, record.starts - 1);
                noise.add(samples * record.fraction, record.noise);
                left += samples * (1 - record.fraction);
                all += samples;
            }
            const FarmTask merge{FarmTask::Kind::merge, r, frame, 1};
            f.merged = records.of(plan, merge).done();
        }
        f.samples = noise.all;
        f.noise = noise.noise();
        status.running += f.running;
        status.frames.push_back(f);
    }
    status.fraction = all > 0 ? 1 - left / all : 0;
    if (status.running > 0)
        status.secondsLeft = left * plan.width * plan.height * plan.sampleSeconds / (plan.cores * status.running);
    if (queued.empty() && status.running == 0) status.idle = true;
    status.outcome = plan.cancelled ? ShotOutcome::cancelled : plan.outcome;
    status.said = plan.said;
    return status;
}

std::string statusTable(const FarmPlan& plan, const FarmFolder& folder, const ShotStatus& status) {
    std::string s = fmt::format(
        "{}  {}: {}x{}, {} samples{}\n", folder.path(), plan.scene, plan.width, plan.height, plan.rounds.back().to,
        plan.noise > 0 ? fmt::format(" so far planned, until {:.3g} % noise", 100 * plan.noise) : std::string());
    s += fmt::format("{:>8} {:>6} {:>6} {:>8} {:>8} {:>7} {:>9} {:>9} {:>8}  {}\n", "frame", "parts", "done", "running",
                     "waiting", "failed", "requeued", "samples", "noise", "image");
    std::size_t rows = 0, left = 0;
    for (const FrameStatus& f : status.frames) {
        const bool dull =
            status.frames.size() > kMostRows && (f.merged || (f.done == 0 && f.running == 0 && f.failed == 0));
        if (dull || rows >= kMostRows) {
            ++left;
            continue;
        }
        ++rows;
        s += fmt::format("{:>8} {:>6} {:>6} {:>8} {:>8} {:>7} {:>9} {:>9.4g} {:>8}  {}\n",
                         plan.animation ? fmt::format("{}", f.frame) : std::string("still"), f.parts, f.done, f.running,
                         f.waiting, f.failed, f.requeued, f.samples,
                         f.noise > 0 ? fmt::format("{:.3g} %", 100 * f.noise) : std::string("-"),
                         f.merged ? "yes" : "no");
    }
    if (left > 0) s += fmt::format("and {} frames that are done or have not begun\n", left);
    s += fmt::format("{}: {:.3g} % of the samples", stateOf(status), 100 * status.fraction);
    if (status.secondsLeft > 0) s += fmt::format(", {} left on {} tasks", timeText(status.secondsLeft), status.running);
    if (!status.said.empty()) s += "; " + status.said;
    return s + "\n";
}

Json statusJson(const FarmPlan& plan, const FarmFolder& folder, const ShotStatus& status) {
    Json frames = Json::list();
    for (const FrameStatus& f : status.frames) {
        const FarmTask merge{FarmTask::Kind::merge, 0, f.frame, 1};
        frames.push(Json::object({{"frame", plan.animation ? Json(f.frame) : Json()},
                                  {"parts", f.parts},
                                  {"done", f.done},
                                  {"running", f.running},
                                  {"waiting", f.waiting},
                                  {"failed", f.failed},
                                  {"requeued", f.requeued},
                                  {"samples", f.samples},
                                  {"noise", f.noise > 0 ? Json(f.noise) : Json()},
                                  {"merged", f.merged},
                                  {"image", folder.outputOf(plan, merge)}}));
    }
    return Json::object({{"folder", folder.path()},
                         {"scene", plan.scene},
                         {"engine", plan.engine == FarmEngineKind::slurm ? "slurm" : "local"},
                         {"state", stateOf(status)},
                         {"said", status.said},
                         {"rounds", static_cast<std::uint64_t>(plan.rounds.size())},
                         {"samples_planned", plan.rounds.back().to},
                         {"noise_goal", plan.noise > 0 ? Json(plan.noise) : Json()},
                         {"fraction", status.fraction},
                         {"seconds_left", status.secondsLeft > 0 ? Json(status.secondsLeft) : Json()},
                         {"running", status.running},
                         {"frames", std::move(frames)}});
}

} // namespace abbe
