// Signals while there is something to save.
#pragma once

#include <atomic>

namespace abbe {

// While there is nothing to save yet: SIGINT and SIGTERM end the process at once, also where they were ignored on
// entry, as shells have it for jobs in the background.
void endOnSignals();

// From construction to destruction SIGINT and SIGTERM set a flag instead of ending the process; the second one leaves
// at once with exit code 128 + signal, and nothing is written any more. SIGUSR1 and SIGHUP ask for a snapshot. At most
// one at a time.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    const std::atomic<bool>& stop() const;
    // Set when a snapshot is asked for; whoever takes it resets it.
    std::atomic<bool>& snapshot() const;
    // As a signal would, without one.
    void requestStop();
    // The signal that came to end it, or 0.
    int signal() const;
};

} // namespace abbe
