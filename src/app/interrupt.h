// Ctrl-C and termination while there is something to save.
#pragma once

#include <atomic>

namespace abbe {

// From construction to destruction SIGINT and SIGTERM set a flag instead of ending the process; the second one leaves
// at once with exit code 128 + signal, and nothing is written any more. At most one at a time.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    const std::atomic<bool>& stop() const;
    // The signal that came, or 0.
    int signal() const;
};

} // namespace abbe
