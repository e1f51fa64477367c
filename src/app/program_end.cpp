#include "app/program_end.h"

#include <csignal>
#include <unistd.h>

namespace abbe {

namespace {

// A signal handler can reach nothing but globals; they are lock-free.
std::atomic<bool> stopRequested{false};
std::atomic<bool> snapshotRequested{false};
std::atomic<int> receivedSignal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void onSignal(int signal) {
    if (receivedSignal.exchange(signal) != 0) _exit(128 + signal);
    stopRequested = true;
}

void onSnapshot(int) { snapshotRequested = true; }

// Also where the signal was ignored on entry, as shells do for jobs in the background: who sends one means it.
void handle(void (*handler)(int), void (*snapshot)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = snapshot;
    sigaction(SIGUSR1, &action, nullptr);
    sigaction(SIGHUP, &action, nullptr);
}

} // namespace

ExitCode worse(ExitCode a, ExitCode b) {
    const auto rank = [](ExitCode c) {
        return c == ExitCode::done ? 0 : c == ExitCode::threshold ? 1 : c == ExitCode::faulty ? 2 : 3;
    };
    return rank(a) >= rank(b) ? a : b;
}

void endOnSignals() {
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

InterruptGuard::InterruptGuard(Signals signals) : signals_(signals) {
    stopRequested = false;
    snapshotRequested = false;
    receivedSignal = 0;
    if (signals_ == Signals::taken) handle(onSignal, onSnapshot);
}

InterruptGuard::~InterruptGuard() {
    if (signals_ == Signals::taken) handle(SIG_DFL, SIG_DFL);
}

const std::atomic<bool>& InterruptGuard::stop() const { return stopRequested; }

std::atomic<bool>& InterruptGuard::snapshot() const { return snapshotRequested; }

void InterruptGuard::requestStop() { stopRequested = true; }

void InterruptGuard::requestStopOfAll() { stopRequested = true; }

int InterruptGuard::signal() const { return receivedSignal; }

} // namespace abbe
