// Processes of this machine as an engine: for tests, and for those who have no cluster. Nothing outlives the command.
#include "app/program_end.h"
#include "base/process.h"
#include "farm/farm_engine.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <thread>

namespace abbe {

namespace {

constexpr auto kLook = std::chrono::milliseconds(20); // at processes that may have ended

class LocalEngine final : public FarmEngine {
  public:
    explicit LocalEngine(const FarmFolder& folder, std::function<void()> tick)
        : folder_(folder), tick_(std::move(tick)) {}

    void submit(FarmPlan& plan, const RoundWork& work) override {
        InterruptGuard interrupt;
        runAll(plan, work.parts, plan.atOnce, interrupt);
        runAll(plan, work.gatherings, 1, interrupt);
        runAll(plan, work.merges, 1, interrupt);
        signal_ = interrupt.signal();
    }

    std::vector<QueuedTask> queue(const FarmPlan&) const override { return {}; } // known to submit() alone
    void cancel(const FarmPlan&) const override {} // whoever runs them sees it in the plan, or gets Ctrl-C
    bool closesItself() const override { return false; }
    int signal() const override { return signal_; }

  private:
    void runAll(const FarmPlan& plan, const std::vector<FarmTask>& tasks, int atOnce, InterruptGuard& interrupt) {
        std::vector<ChildProcess> running;
        std::size_t next = 0;
        bool told = false;
        std::error_code unreadable;
        while (next < tasks.size() || !running.empty()) {
            const bool stop = interrupt.stop() || std::filesystem::exists(folder_.cancelFile(), unreadable);
            if (stop) next = tasks.size();
            while (next < tasks.size() && static_cast<int>(running.size()) < atOnce)
                running.push_back(start(plan, tasks[next++]));
            if (stop && !told) {
                for (ChildProcess& child : running) child.terminate();
                told = true;
            }
            std::this_thread::sleep_for(kLook);
            std::vector<ChildProcess> still;
            for (ChildProcess& child : running)
                if (child.running()) still.push_back(std::move(child));
            running.swap(still);
            if (tick_) tick_();
        }
    }

    ChildProcess start(const FarmPlan& plan, const FarmTask& task) const {
        const std::vector<FarmTask> all = tasksOf(plan, task.round, task.kind);
        const auto same = [&](const FarmTask& t) { return t.frame == task.frame && t.piece == task.piece; };
        const auto number = std::ranges::find_if(all, same) - all.begin() + 1;
        const char* kind = task.kind == FarmTask::Kind::part     ? "part"
                           : task.kind == FarmTask::Kind::gather ? "gather"
                                                                 : "merge";
        return {{plan.executable, "farm", "work", folder_.path(), fmt::format("{}", task.round + 1), kind,
                 fmt::format("{}", number), "-t", fmt::format("{}", plan.cores)},
                folder_.logFile(plan, task)};
    }

    const FarmFolder& folder_;
    std::function<void()> tick_;
    int signal_ = 0;
};

} // namespace

std::unique_ptr<FarmEngine> makeLocalEngine(const FarmFolder& folder, std::function<void()> tick) {
    return std::make_unique<LocalEngine>(folder, std::move(tick));
}

std::unique_ptr<FarmEngine> makeEngine(FarmEngineKind kind, const FarmFolder& folder, std::function<void()> tick) {
    return kind == FarmEngineKind::slurm ? makeSlurm(folder) : makeLocalEngine(folder, std::move(tick));
}

} // namespace abbe
