#include "app/interrupt.h"

#include <csignal>
#include <unistd.h>

namespace abbe {

namespace {

// A signal handler can reach nothing but globals; both are lock-free.
std::atomic<bool> stopRequested{false};
std::atomic<int> receivedSignal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void onSignal(int signal) {
    if (receivedSignal.exchange(signal) != 0) _exit(128 + signal);
    stopRequested = true;
}

// Also where the signal was ignored on entry, as shells do for jobs in the background: who sends one means it.
void handle(void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

} // namespace

InterruptGuard::InterruptGuard() {
    stopRequested = false;
    receivedSignal = 0;
    handle(onSignal);
}

InterruptGuard::~InterruptGuard() { handle(SIG_DFL); }

const std::atomic<bool>& InterruptGuard::stop() const { return stopRequested; }

int InterruptGuard::signal() const { return receivedSignal; }

} // namespace abbe
