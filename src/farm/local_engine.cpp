// Processes of this machine as an engine: for tests, and for those who have no cluster. Nothing outlives the command.
#include "app/program_end.h"
#include "base/process.h"
#include "farm/farm_engine.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <thread>

namespace abbe {

namespace {

constexpr auto kLook = std::chrono::milliseconds(20); // at processes that may have ended

class LocalEngine final : public FarmEngine {
  public:
    explicit LocalEngine(const FarmFolder& folder) : folder_(folder) {}

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
        while (next < tasks.size() || !running.empty()) {
            const bool stop = interrupt.stop() || folder_.isCancelled();
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
        }
    }

    ChildProcess start(const FarmPlan& plan, const FarmTask& task) const {
        return {{plan.executable, "farm", "work", folder_.path(), fmt::format("{}", task.round + 1), wordOf(task.kind),
                 fmt::format("{}", numberOf(plan, task)), "-t", fmt::format("{}", plan.cores)},
                folder_.logFile(plan, task)};
    }

    const FarmFolder& folder_;
    int signal_ = 0;
};

} // namespace

std::unique_ptr<FarmEngine> makeLocalEngine(const FarmFolder& folder) { return std::make_unique<LocalEngine>(folder); }

std::unique_ptr<FarmEngine> makeEngine(FarmEngineKind kind, const FarmFolder& folder) {
    return kind == FarmEngineKind::slurm ? makeSlurm(folder) : makeLocalEngine(folder);
}

} // namespace abbe
