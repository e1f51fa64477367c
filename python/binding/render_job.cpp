#include "binding/render_job.h"

#include "base/memory_limit.h"
#include "base/parallel.h"
#include "binding/background.h"
#include "binding/command_words.h"
#include "binding/scene_handle.h"

#include <chrono>
#include <utility>

namespace abbe::python {

// Everything that a render tells goes to the job.
class RenderJob::Host final : public RenderHost {
  public:
    explicit Host(RenderJob& job) : job_(job) {}

    std::unique_ptr<RenderReport> report() override { return std::make_unique<Report>(job_); }
    void take(HeldImage image) override { job_.outcome_.image = std::make_shared<HeldImage>(std::move(image)); }

  private:
    class Report final : public RenderReport {
      public:
        explicit Report(RenderJob& job) : job_(job) {}
        void start(const RenderStart&) override {}
        void phase(const std::string& name, double) override { job_.endPhase(name); }
        void progress(const Progress& p) override {
            {
                const std::scoped_lock lock(job_.mutex_);
                job_.progress_ = p;
            }
            job_.changed_.notify_all();
        }
        void image(const std::string& path, bool) override { job_.outcome_.files.push_back(path); }
        void preview(const std::string&) override {}
        void diagnostics(const Diagnostics& d, const SourceMap& sources) override {
            job_.outcome_.log->add(d, sources);
        }
        void done(const RenderSummary& summary) override { job_.outcome_.summary = summary; }

      private:
        RenderJob& job_;
    };

    RenderJob& job_;
};

RenderJob::RenderJob(std::shared_ptr<SceneHandle> scene, RenderOptions options, int threads)
    : scene_(std::move(scene)), options_(std::move(options)) {
    outcome_.log = std::make_shared<DiagnosticLog>();
    common_.words = commandWords(options_);
    common_.commandLine = commandLine(common_.words);
    common_.threads = threads;
    thread_ = std::make_unique<std::thread>([this] { run(); });
}

RenderJob::~RenderJob() {
    while (!done()) {
        stop();
        wait();
    }
    thread_->join();
}

bool RenderJob::wantsStop() {
    const std::scoped_lock lock(mutex_);
    return stopWanted_;
}

void RenderJob::begin() {
    const std::scoped_lock lock(mutex_);
    running_ = true;
}

// A scene is read and built to its end, which nothing interrupts; between the two, and before the first sample, a
// render does.
void RenderJob::endPhase(const std::string& name) {
    {
        const std::scoped_lock lock(mutex_);
        if (built_) return;
        built_ = name == "committing"; // the last of building
    }
    if (wantsStop()) throw RenderStopped("the render was stopped before it began");
}

bool RenderJob::isBuilt() {
    const std::scoped_lock lock(mutex_);
    return built_;
}

void RenderJob::abandon(std::unique_ptr<RenderJob> job) {
    job->stop();
    std::thread([job = std::move(job), abandoned = std::make_unique<Abandoned>()]() mutable { job.reset(); }).detach();
}

void RenderJob::run() {
    try {
        const std::scoped_lock lock(SceneHandle::oneAtATime());
        begin();
        if (wantsStop()) throw RenderStopped("the render was stopped before it began");
        setThreadCount(common_.threads);
        if (options_.memory) setMemoryLimit(*options_.memory * (1 << 20));
        Host host(*this);
        outcome_.exit = RenderRun(options_, common_, scene_ ? &scene_->carry() : nullptr, &host).run();
    } catch (...) {
        fault_ = std::current_exception();
    }
    {
        const std::scoped_lock lock(mutex_);
        done_ = true;
        running_ = false;
    }
    changed_.notify_all();
}

void RenderJob::wait() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(50), [this] { return done_ || progress_.has_value(); });
}

bool RenderJob::done() {
    const std::scoped_lock lock(mutex_);
    return done_;
}

std::optional<Progress> RenderJob::takeProgress() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(progress_, std::nullopt);
}

// Another job's render must not end by it, for whose end this one may wait.
void RenderJob::stop() {
    const std::scoped_lock lock(mutex_);
    stopWanted_ = true;
    if (running_) InterruptGuard::requestStopOfAll();
}

RenderOutcome RenderJob::outcome() {
    if (fault_) std::rethrow_exception(fault_);
    return std::move(outcome_);
}

} // namespace abbe::python
