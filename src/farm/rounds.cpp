#include "farm/rounds.h"

#include "farm/task_record.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

// Error falls at least as fast as one over the root of the samples.
constexpr double kSpare = 1.1, kMostGrowth = 4;

std::vector<FarmTask> undone(const FarmPlan& plan, TaskRecords& records, std::vector<FarmTask> tasks) {
    std::erase_if(tasks, [&](const FarmTask& t) { return records.of(plan, t).done(); });
    return tasks;
}

// What of a round is not done yet, and can be.
RoundWork missingOf(const FarmPlan& plan, TaskRecords& records, int round) {
    return {round, undone(plan, records, tasksOf(plan, round, FarmTask::Kind::part)),
            undone(plan, records, tasksOf(plan, round, FarmTask::Kind::gather)),
            undone(plan, records, tasksOf(plan, round, FarmTask::Kind::merge))};
}

std::string nameOfFrame(const FarmPlan& plan, int frame) {
    return plan.animation ? fmt::format("frame {}", frame) : std::string("the image");
}

// What the measured parts took, which knows more than the pilot did.
double measuredSampleSeconds(const FarmPlan& plan, TaskRecords& records, int round) {
    double seconds = 0, samples = 0;
    const FarmRound& r = plan.rounds[static_cast<std::size_t>(round)];
    for (const FarmTask& task : tasksOf(plan, round, FarmTask::Kind::part)) {
        const TaskRecord& record = records.of(plan, task);
        if (record.coreSeconds <= 0 || record.starts != 1) continue; // of one that went on, a part is known
        seconds += record.coreSeconds;
        samples += static_cast<double>(plan.width) * plan.height * (r.to - r.from) / r.parts;
    }
    return samples > 0 ? seconds / samples : plan.sampleSeconds;
}

// The frames whose error is above the goal, and the samples that should do.
RoundEnd planMore(FarmPlan& plan, TaskRecords& records, int round) {
    RoundEnd end;
    FarmRound next;
    const FarmRound last = plan.rounds[static_cast<std::size_t>(round)];
    double worst = 0;
    for (const FarmTask& task : tasksOf(plan, round, FarmTask::Kind::merge)) {
        const double noise = records.of(plan, task).noise;
        if (noise <= plan.noise) continue; // 0: nothing differs between samples, as in a black frame
        next.frames.push_back(task.frame);
        worst = std::max(worst, noise);
    }
    if (next.frames.empty()) {
        end.outcome = ShotOutcome::done;
        end.said = fmt::format("the noise goal of {:.3g} % is met", 100 * plan.noise);
        return end;
    }
    if (last.to >= plan.samples) {
        end.outcome = ShotOutcome::limit;
        end.said = fmt::format("{} of {} have more noise than {:.3g} % after {} samples, the most that they may have; "
                               "the worst has {:.3g} %",
                               next.frames.size(), last.frames.size(), 100 * plan.noise, last.to, 100 * worst);
        return end;
    }
    const double factor = std::min(kMostGrowth, kSpare * worst * worst / (plan.noise * plan.noise));
    const auto replicates = static_cast<std::uint32_t>(plan.replicates);
    const double wanted = std::ceil(last.to * factor / replicates) * replicates;
    next.from = last.to;
    next.to = static_cast<std::uint32_t>(std::clamp<double>(wanted, last.to + replicates, plan.samples));
    plan.sampleSeconds = measuredSampleSeconds(plan, records, round);
    next.parts = partsOf(plan, next.from, next.to);
    end.said = fmt::format("{} of {} have up to {:.3g} % noise; a round to {} samples is next", next.frames.size(),
                           last.frames.size(), 100 * worst, next.to);
    plan.rounds.push_back(std::move(next));
    end.work = workOf(plan, round + 1);
    return end;
}

// Why a round cannot be done, if so: the first task that would end the same way again.
std::string hopelessTask(const FarmPlan& plan, const FarmFolder& folder, TaskRecords& records, const RoundWork& work) {
    for (const auto* tasks : {&work.parts, &work.gatherings, &work.merges})
        for (const FarmTask& task : *tasks) {
            const TaskRecord& record = records.of(plan, task);
            // What is merged may only lack what failed itself.
            if (!record.hopeless() || (task.kind != FarmTask::Kind::part && !work.parts.empty())) continue;
            return fmt::format("{} ended with {}{}", folder.nameOf(plan, task), *record.exit,
                               record.fault.empty() ? fmt::format(": see `{}`", folder.logFile(plan, task))
                                                    : ": " + record.fault);
        }
    return {};
}

} // namespace

RoundWork workOf(const FarmPlan& plan, int round) {
    return {round, tasksOf(plan, round, FarmTask::Kind::part), tasksOf(plan, round, FarmTask::Kind::gather),
            tasksOf(plan, round, FarmTask::Kind::merge)};
}

RoundEnd closeRound(FarmPlan& plan, const FarmFolder& folder, int round) {
    RoundEnd end;
    if (plan.cancelled) return {ShotOutcome::cancelled, {}, "the shot was cancelled"};
    TaskRecords records(folder);
    end.work = missingOf(plan, records, round);
    if (end.work.empty()) {
        if (plan.noise > 0) return planMore(plan, records, round);
        end.outcome = ShotOutcome::done;
        end.said = plan.animation ? fmt::format("all {} frames are done", plan.rounds[0].frames.size())
                                  : std::string("the image is done");
        return end;
    }
    FarmRound& r = plan.rounds[static_cast<std::size_t>(round)];
    const std::string hopeless = hopelessTask(plan, folder, records, end.work);
    if (!hopeless.empty() || r.tries >= plan.mostTries) {
        end.outcome = ShotOutcome::failed;
        const FarmTask& first = !end.work.parts.empty()        ? end.work.parts[0]
                                : !end.work.gatherings.empty() ? end.work.gatherings[0]
                                                               : end.work.merges[0];
        end.said = !hopeless.empty() ? hopeless
                                     : fmt::format("{} of {} was not done in {} tries", folder.nameOf(plan, first),
                                                   nameOfFrame(plan, first.frame), r.tries + 1);
        return end;
    }
    ++r.tries;
    std::error_code ignored;
    for (const auto* tasks : {&end.work.parts, &end.work.gatherings, &end.work.merges})
        for (const FarmTask& task : *tasks) std::filesystem::remove(folder.resultFile(plan, task), ignored);
    end.said = fmt::format("{} parts and {} images are missing; try {} of {}", end.work.parts.size(),
                           end.work.merges.size(), r.tries + 1, plan.mostTries + 1);
    return end;
}

} // namespace abbe
