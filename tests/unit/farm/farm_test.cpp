#include "farm/farm_plan.h"
#include "farm/rounds.h"
#include "farm/shot_status.h"
#include "farm/task_record.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <unistd.h>

using namespace abbe;

namespace {

namespace fs = std::filesystem;

// A folder with a shot of two frames, of which nothing is done.
struct Shot {
    Shot() : folder((fs::temp_directory_path() / fmt::format("abbe_farm_{}", ::getpid())).string()) {
        for (const char* name : {"/parts", "/tasks", "/log"}) fs::create_directories(folder.path() + name);
        plan.animation = true;
        plan.width = plan.height = 100;
        plan.replicates = 2;
        plan.samples = 1000;
        plan.sampleSeconds = 1e-3;
        plan.image = folder.path() + "/shot.####.exr";
        plan.rounds = {{0, 32, 2, {1, 2}, 0}};
    }
    ~Shot() { fs::remove_all(folder.path()); }

    // As a task would have left it.
    void finish(const FarmTask& task, double noise, int exit = 0) {
        std::ofstream(folder.eventsFile(plan, task), std::ios::app) << fmt::format(
            "{{\"event\":\"start\"}}\n{{\"event\":\"done\",\"core_seconds\":3.2,\"noise\":{}}}\n", noise);
        writeTaskResult(plan, folder, task, exit);
        if (exit == 0) std::ofstream(folder.outputOf(plan, task)) << "x";
    }
    void finishRound(int round, double noise) {
        for (const auto kind : {FarmTask::Kind::part, FarmTask::Kind::gather, FarmTask::Kind::merge})
            for (const FarmTask& task : tasksOf(plan, round, kind)) finish(task, noise);
    }

    FarmFolder folder;
    FarmPlan plan;
};

} // namespace

TEST_CASE("groups of parts hold every part once, and none reads more files than the root") {
    for (const int parts : {1, 24, 25, 100, 256, 1000, 1001}) {
        Shot shot;
        shot.plan.rounds[0].parts = parts;
        std::multiset<std::string> merged;
        for (const FarmTask& gather : tasksOf(shot.plan, 0, FarmTask::Kind::gather)) {
            if (gather.frame != 2) continue;
            const auto inputs = shot.folder.inputsOf(shot.plan, gather);
            CHECK(!inputs.empty());
            CHECK(inputs.size() <= std::ceil(std::sqrt(parts)));
            merged.insert(inputs.begin(), inputs.end());
        }
        const auto inputs = shot.folder.inputsOf(shot.plan, {FarmTask::Kind::merge, 0, 2, 1});
        CHECK(inputs.size() <=
              std::max<std::size_t>(kMostMergedParts, static_cast<std::size_t>(std::ceil(std::sqrt(parts)))));
        if (merged.empty()) merged.insert(inputs.begin(), inputs.end());
        CHECK(merged.size() == static_cast<std::size_t>(parts));
        CHECK(std::set(merged.begin(), merged.end()).size() == merged.size());
    }
}

TEST_CASE("a frame has as many parts as take the time that is asked for, and no part without samples") {
    FarmPlan plan;
    plan.width = plan.height = 1000;
    plan.replicates = 2;
    plan.sampleSeconds = 1e-4; // 100 s a sample of all pixels
    plan.chunkSeconds = 600;
    plan.cores = 2;
    CHECK(partsOf(plan, 0, 2) == 1);
    CHECK(partsOf(plan, 0, 24) == 2);
    CHECK(partsOf(plan, 24, 48) == 2);
    CHECK(partsOf(plan, 0, 26) == 3);
    plan.chunkSeconds = 1;
    CHECK(partsOf(plan, 0, 24) == 12); // a sample of each replicate
    plan.parts = 5;
    CHECK(partsOf(plan, 0, 24) == 5);
}

TEST_CASE("a plan is what was written, and another program's is refused") {
    Shot shot;
    shot.plan.renderWords = {"--size=20x10", "-D", "a=\"b c\""};
    shot.plan.rounds.push_back({32, 64, 3, {2}, 1});
    shot.plan.jobs = {"12", "13"};
    shot.plan.offsets["13"] = 1000;
    shot.plan.outcome = ShotOutcome::limit;
    shot.folder.writePlan(shot.plan);
    FarmPlan back = shot.folder.readPlan();
    CHECK(back.renderWords == shot.plan.renderWords);
    CHECK(back.rounds.size() == 2);
    CHECK(back.rounds[1].from == 32);
    CHECK(back.rounds[1].frames == std::vector<int>{2});
    CHECK(back.offsets == shot.plan.offsets);
    CHECK(back.outcome == shot.plan.outcome);
    CHECK(!back.cancelled);
    CHECK(!outcomeNamed(""));
    for (const auto outcome : {ShotOutcome::done, ShotOutcome::limit, ShotOutcome::failed, ShotOutcome::cancelled})
        CHECK(outcomeNamed(wordOf(outcome)) == outcome);
    shot.folder.setCancelled(true);
    CHECK(shot.folder.readPlan().cancelled);
    back.program = "abbe 0.0.1";
    shot.folder.writePlan(back);
    CHECK_THROWS_AS(shot.folder.readPlan(), FarmFault);
    for (const char* text : {"", "{", "[]", "{\"format\": 1}", "{\"format\": 2}"}) {
        std::ofstream(shot.folder.planFile()) << text;
        CHECK_THROWS_AS(shot.folder.readPlan(), FarmFault);
    }
}

TEST_CASE("a round ends with what is missing, as often as it may be tried, and with a hopeless task at once") {
    Shot shot;
    const FarmTask lost{FarmTask::Kind::part, 0, 2, 1};
    shot.finishRound(0, 0.1);
    fs::remove(shot.folder.outputOf(shot.plan, lost));
    fs::remove(shot.folder.resultFile(shot.plan, {FarmTask::Kind::merge, 0, 2, 1}));
    RoundEnd end = closeRound(shot.plan, shot.folder, 0);
    CHECK(!end.outcome);
    CHECK(end.work.round == 0);
    REQUIRE(end.work.parts.size() == 1);
    CHECK(end.work.parts[0].frame == 2);
    CHECK(end.work.merges.size() == 1);
    CHECK(!closeRound(shot.plan, shot.folder, 0).outcome);
    CHECK(closeRound(shot.plan, shot.folder, 0).outcome == ShotOutcome::failed);
    shot.plan.rounds[0].tries = 0;
    shot.finish(lost, 0.1, 1);
    end = closeRound(shot.plan, shot.folder, 0);
    CHECK(end.outcome == ShotOutcome::failed);
    CHECK(end.said.find("r1.0002.p1") != std::string::npos);
    shot.finish(lost, 0.1);
    shot.finish({FarmTask::Kind::merge, 0, 2, 1}, 0.1);
    CHECK(closeRound(shot.plan, shot.folder, 0).outcome == ShotOutcome::done);
}

TEST_CASE("a noise goal asks for as many samples as error needs that falls by the root of them") {
    Shot shot;
    shot.plan.noise = 0.05;
    shot.plan.parts = 2;
    shot.finishRound(0, 0.04);
    CHECK(closeRound(shot.plan, shot.folder, 0).outcome == ShotOutcome::done);
    shot.finish({FarmTask::Kind::merge, 0, 1, 1}, 0); // a black frame
    CHECK(closeRound(shot.plan, shot.folder, 0).outcome == ShotOutcome::done);
    shot.finish({FarmTask::Kind::merge, 0, 2, 1}, 0.07); // (7/5)² × 1.1 × 32 = 68.99
    const RoundEnd end = closeRound(shot.plan, shot.folder, 0);
    CHECK(!end.outcome);
    CHECK(end.work.round == 1);
    REQUIRE(shot.plan.rounds.size() == 2);
    CHECK(shot.plan.rounds[1].frames == std::vector<int>{2});
    CHECK(shot.plan.rounds[1].from == 32);
    CHECK(shot.plan.rounds[1].to == 70);
    // Only what that frame has of both rounds is merged.
    CHECK(shot.folder.inputsOf(shot.plan, end.work.merges[0]).size() == 4);
    shot.finishRound(1, 0.3); // four times as many at most,
    CHECK(!closeRound(shot.plan, shot.folder, 1).outcome);
    CHECK(shot.plan.rounds[2].to == 280);
    shot.finishRound(2, 0.3); // and no more than there may be
    CHECK(!closeRound(shot.plan, shot.folder, 2).outcome);
    CHECK(shot.plan.rounds[3].to == 1000);
    shot.finishRound(3, 0.3);
    CHECK(closeRound(shot.plan, shot.folder, 3).outcome == ShotOutcome::limit);
}

TEST_CASE("the status counts parts, and the noise of their mean") {
    Shot shot;
    TaskRecords records(shot.folder);
    ShotStatus status = statusOf(shot.plan, shot.folder, records, {});
    CHECK(status.idle);
    CHECK(!status.outcome);
    CHECK(status.fraction == 0);
    shot.finish({FarmTask::Kind::part, 0, 1, 1}, 0.1);
    shot.finish({FarmTask::Kind::part, 0, 1, 2}, 0.1);
    shot.finish({FarmTask::Kind::part, 0, 2, 1}, 0.1, 3);
    records.forgetUndone();
    status = statusOf(shot.plan, shot.folder, records, {{"r1.0002.p2", "running", "n1"}});
    CHECK(!status.idle);
    CHECK(status.frames[0].done == 2);
    CHECK(status.frames[0].noise == doctest::Approx(0.1 / std::sqrt(2)));
    CHECK(status.frames[0].samples == 32);
    CHECK(status.frames[1].failed == 1);
    CHECK(status.frames[1].running == 1);
    CHECK(status.fraction == doctest::Approx(0.5));
    // What is done is not read again while its file is there.
    fs::remove(shot.folder.outputOf(shot.plan, {FarmTask::Kind::part, 0, 1, 1}));
    CHECK(statusOf(shot.plan, shot.folder, records, {}).frames[0].done == 2);
    records.forgetUndone();
    CHECK(statusOf(shot.plan, shot.folder, records, {}).frames[0].done == 1);
    // Lines that are torn count for nothing.
    std::ofstream(shot.folder.eventsFile(shot.plan, {FarmTask::Kind::part, 0, 2, 2})) << "{\"event\":\"sta";
    CHECK(readTaskRecord(shot.plan, shot.folder, {FarmTask::Kind::part, 0, 2, 2}).starts == 0);
}
