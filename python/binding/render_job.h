// One render for Python: it works on a thread of its own while the caller's looks after Python.
#pragma once

#include "binding/diagnostic_records.h"
#include "binding/scene_handle.h"
#include "render_run/render_options.h"
#include "render_run/render_run.h"

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace abbe::python {

class RenderStopped : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// What a render came to.
struct RenderOutcome {
    ExitCode exit = ExitCode::done;
    std::shared_ptr<DiagnosticLog> log;
    std::shared_ptr<HeldImage> image;     // null: none was made
    std::optional<RenderSummary> summary; // nothing if it ended before
    std::vector<std::string> files;       // that were written, in order
};

// Starts with construction. Needs no lock of Python's; the destructor waits for the end.
class RenderJob {
  public:
    // `scene` may be null where parts of one are merged. `threads` 0: one for each core.
    RenderJob(std::shared_ptr<SceneHandle> scene, RenderOptions, int threads);
    ~RenderJob();
    RenderJob(const RenderJob&) = delete;
    RenderJob& operator=(const RenderJob&) = delete;

    // Waits until there is a new state, or the end, or a twentieth of a second is over.
    void wait();
    bool done();
    // The newest state, once each.
    std::optional<Progress> takeProgress();
    // To be called again until done(): a render that only begins takes no notice.
    void stop();
    // Whether reading and building are over, so that it ends soon after stop().
    bool isBuilt();
    // Stops a job that need not be waited for: its destructor is run elsewhere, when it has come to an end.
    static void abandon(std::unique_ptr<RenderJob>);
    // After done(). Throws what the render threw.
    RenderOutcome outcome();

  private:
    class Host;
    void begin();
    bool wantsStop();
    void endPhase(const std::string& name);
    void run();

    std::shared_ptr<SceneHandle> scene_;
    RenderOptions options_;
    CommonOptions common_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Progress> progress_;
    RenderOutcome outcome_;
    std::exception_ptr fault_;
    bool done_ = false, running_ = false, built_ = false, stopWanted_ = false;
    std::unique_ptr<std::thread> thread_;
};

} // namespace abbe::python
