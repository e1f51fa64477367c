#include "farm/farm_plan.h"

#include "app/frame_list.h"
#include "checkpoints/render_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace abbe {

int groupSize(const FarmRound& round) {
    if (round.parts <= kMostMergedParts) return 0;
    return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(round.parts))));
}

int groupCount(const FarmRound& round) {
    const int size = groupSize(round);
    return size == 0 ? 0 : (round.parts + size - 1) / size;
}

int partsOf(const FarmPlan& plan, std::uint32_t from, std::uint32_t to) {
    const double most = (to - from) / static_cast<std::uint32_t>(plan.replicates);
    const double seconds = plan.sampleSeconds * plan.width * plan.height * (to - from) / plan.cores;
    const double wanted = plan.parts > 0 ? plan.parts : std::ceil(seconds / plan.chunkSeconds);
    return static_cast<int>(std::clamp(wanted, 1.0, std::max(1.0, most)));
}

namespace {

constexpr std::array kOutcomes{std::pair{ShotOutcome::done, "done"}, std::pair{ShotOutcome::limit, "limit"},
                               std::pair{ShotOutcome::failed, "failed"},
                               std::pair{ShotOutcome::cancelled, "cancelled"}};

} // namespace

const char* wordOf(ShotOutcome outcome) {
    return std::ranges::find(kOutcomes, outcome, &decltype(kOutcomes)::value_type::first)->second;
}

std::optional<ShotOutcome> outcomeNamed(std::string_view word) {
    for (const auto& [outcome, name] : kOutcomes)
        if (name == word) return outcome;
    return std::nullopt;
}

const char* wordOf(FarmTask::Kind kind) {
    switch (kind) {
    case FarmTask::Kind::part:
        return "part";
    case FarmTask::Kind::gather:
        return "gather";
    case FarmTask::Kind::merge:
        return "merge";
    }
    return "";
}

namespace {

int piecesOf(const FarmRound& round, FarmTask::Kind kind) {
    return kind == FarmTask::Kind::part ? round.parts : kind == FarmTask::Kind::gather ? groupCount(round) : 1;
}

} // namespace

std::vector<FarmTask> tasksOf(const FarmPlan& plan, int round, FarmTask::Kind kind) {
    const FarmRound& r = plan.rounds[static_cast<std::size_t>(round)];
    std::vector<FarmTask> tasks;
    for (const int frame : r.frames)
        for (int piece = 1; piece <= piecesOf(r, kind); ++piece) tasks.push_back({kind, round, frame, piece});
    return tasks;
}

int numberOf(const FarmPlan& plan, const FarmTask& task) {
    const FarmRound& round = plan.rounds[static_cast<std::size_t>(task.round)];
    const auto frame = std::ranges::find(round.frames, task.frame) - round.frames.begin();
    return static_cast<int>(frame) * piecesOf(round, task.kind) + task.piece;
}

std::string FarmFolder::nameOf(const FarmPlan& plan, const FarmTask& task) const {
    std::string name = fmt::format("r{}", task.round + 1);
    if (plan.animation) name += fmt::format(".{:04}", task.frame);
    if (task.kind == FarmTask::Kind::part) name += fmt::format(".p{}", task.piece);
    if (task.kind == FarmTask::Kind::gather) name += fmt::format(".g{}", task.piece);
    return name;
}

std::string FarmFolder::partPattern(const FarmPlan& plan, const FarmTask& task) const {
    return fmt::format("{}/parts/r{}{}.exr", path_, task.round + 1, plan.animation ? ".####" : "");
}

std::string FarmFolder::outputOf(const FarmPlan& plan, const FarmTask& task) const {
    const auto framed = [&](const std::string& pattern) {
        return plan.animation ? framePath(pattern, task.frame) : pattern;
    };
    const FarmRound& round = plan.rounds[static_cast<std::size_t>(task.round)];
    switch (task.kind) {
    case FarmTask::Kind::part:
        return partPath(framed(partPattern(plan, task)), {task.piece, round.parts});
    case FarmTask::Kind::gather:
        return fmt::format("{}/parts/{}.abbe", path_, nameOf(plan, task));
    case FarmTask::Kind::merge:
        return framed(plan.image);
    }
    return {};
}

std::vector<std::string> FarmFolder::inputsOf(const FarmPlan& plan, const FarmTask& task) const {
    std::vector<std::string> files;
    const auto add = [&](int round, FarmTask::Kind kind, int from, int to) {
        for (int piece = from; piece <= to; ++piece) files.push_back(outputOf(plan, {kind, round, task.frame, piece}));
    };
    if (task.kind == FarmTask::Kind::gather) {
        const FarmRound& round = plan.rounds[static_cast<std::size_t>(task.round)];
        const int size = groupSize(round);
        add(task.round, FarmTask::Kind::part, (task.piece - 1) * size + 1, std::min(task.piece * size, round.parts));
        return files;
    }
    for (int r = 0; r <= task.round; ++r) {
        const FarmRound& round = plan.rounds[static_cast<std::size_t>(r)];
        if (std::ranges::find(round.frames, task.frame) == round.frames.end()) continue;
        if (groupCount(round) > 0)
            add(r, FarmTask::Kind::gather, 1, groupCount(round));
        else
            add(r, FarmTask::Kind::part, 1, round.parts);
    }
    return files;
}

std::vector<std::string> FarmFolder::commandOf(const FarmPlan& plan, const FarmTask& task) const {
    const FarmRound& round = plan.rounds[static_cast<std::size_t>(task.round)];
    std::vector<std::string> words;
    if (task.kind == FarmTask::Kind::part) {
        words = {"render", plan.scene};
        words.insert(words.end(), plan.renderWords.begin(), plan.renderWords.end());
        if (plan.animation) words.push_back(fmt::format("--frames={}", task.frame));
        words.push_back(fmt::format("--samples={}", round.to));
        if (round.from > 0) words.push_back(fmt::format("--skip={}", round.from));
        words.push_back(fmt::format("--part={}/{}", task.piece, round.parts));
        words.insert(words.end(), {"-o", partPattern(plan, task), "--resume", "--json", "--progress=5s"});
        return words;
    }
    words = {"merge", "-o", outputOf(plan, task), "--json"};
    if (task.kind == FarmTask::Kind::merge)
        words.insert(words.end(), plan.mergeWords.begin(), plan.mergeWords.end());
    else
        words.push_back("--png=off");
    words.push_back("--");
    for (const std::string& file : inputsOf(plan, task)) words.push_back(file);
    return words;
}

} // namespace abbe
