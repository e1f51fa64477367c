// How the program ends (the codes are documented in docs/command_line.md), and signals while there is something to
// save.
#pragma once

#include <atomic>

namespace abbe {

enum class ExitCode : int {
    done = 0,          // also when a time limit or a noise goal ended the render
    faulty = 1,        // the scene or an image has errors
    usage = 2,         // wrong command line
    system = 3,        // a file cannot be read or written
    threshold = 4,     // a comparison exceeded its threshold, or --strict and there were warnings
    memory = 5,        // out of memory
    internal = 70,     // a bug of the program
    interrupted = 130, // by SIGINT, after saving; SIGTERM: 143
    terminated = 143,
};

struct ExitCodeText {
    ExitCode code;
    const char* meaning;
};
inline constexpr ExitCodeText kExitCodes[] = {
    {ExitCode::done, "done; also when a time limit or a noise goal ended the render"},
    {ExitCode::faulty, "the scene or an image has errors"},
    {ExitCode::usage, "wrong command line"},
    {ExitCode::system, "a file cannot be read or written"},
    {ExitCode::threshold, "a threshold was exceeded, a check failed, or there were warnings with --strict"},
    {ExitCode::memory, "out of memory"},
    {ExitCode::internal, "a bug of the program"},
    {ExitCode::interrupted, "interrupted by Ctrl-C, after saving"},
    {ExitCode::terminated, "ended by SIGTERM, after saving"},
};

// The one that matters more, where several files end in different ways: none fails silently for another.
ExitCode worse(ExitCode, ExitCode);

// While there is nothing to save yet: SIGINT and SIGTERM end the process at once, also where they were ignored on
// entry, as shells have it for jobs in the background.
void endOnSignals();

// From construction to destruction SIGINT and SIGTERM set a flag instead of ending the process; the second one leaves
// at once with exit code 128 + signal, and nothing is written any more. SIGUSR1 and SIGHUP ask for a snapshot. At most
// one at a time.
class InterruptGuard {
  public:
    // `left`: signals are another program's, in which this one is a library; only requestStop() ends the work.
    enum class Signals : bool { taken, left };
    explicit InterruptGuard(Signals = Signals::taken);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    const std::atomic<bool>& stop() const;
    // Set when a snapshot is asked for; whoever takes it resets it.
    std::atomic<bool>& snapshot() const;
    // As a signal would, without one.
    void requestStop();
    // The same from any thread, for who has no guard; of no effect on one that begins later.
    static void requestStopOfAll();
    // The signal that came to end it, or 0.
    int signal() const;

  private:
    Signals signals_;
};

} // namespace abbe
