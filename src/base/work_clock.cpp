#include "base/work_clock.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace abbe {

namespace {

// The states of all threads that show theirs.
struct ShownThreads {
    std::mutex mutex;
    std::vector<const WorkState*> states;
};
ShownThreads& shownThreads() {
    static ShownThreads* const all = new ShownThreads; // threads may end after statics are gone
    return *all;
}

class Shown {
  public:
    Shown() {
        const std::lock_guard lock(shownThreads().mutex);
        shownThreads().states.push_back(&workState);
    }
    ~Shown() {
        const std::lock_guard lock(shownThreads().mutex);
        std::erase(shownThreads().states, &workState);
    }
};

} // namespace

void showWork() { thread_local const Shown shown; }

double untilNextLook(double elapsed, double& spread) {
    spread = std::fmod(spread + 0.6180339887498949, 1.0);
    return std::clamp(elapsed * 2e-4, 0.002, 0.01) * (0.5 + spread);
}

struct WorkClock::Impl {
    using Clock = std::chrono::steady_clock;

    // Seen of one thread at one moment.
    struct Look {
        std::uint8_t work, flags, cause;
    };
    static Look lookAt(const WorkState& s) {
        return {s.work.load(std::memory_order_relaxed), s.flags.load(std::memory_order_relaxed),
                s.cause.load(std::memory_order_relaxed)};
    }

    void charge(Look at, double seconds) {
        WorkCharge& c = reading.charges[WorkReading::index(at.work, at.flags, at.cause)];
        c.seconds += seconds;
        c.squares += seconds * seconds;
        ++c.looks;
    }

    // Requires the mutex. Allocates nothing: memory may be what the program runs out of.
    void look() {
        const auto now = Clock::now();
        const double since = std::chrono::duration<double>(now - last).count();
        last = now;
        reading.seconds += since;
        const Look program = lookAt(*owner);
        if (program.work != 0 && program.work <= static_cast<std::uint8_t>(Work::preparing))
            return charge({program.work, 0, 0}, since);
        ShownThreads& all = shownThreads();
        const std::lock_guard lock(all.mutex);
        int busy = 0;
        for (const WorkState* state : all.states) busy += lookAt(*state).work != 0;
        // More than `threads` at work have less than a processor each.
        const double share = since / std::max(threads, busy);
        int charged = 0;
        for (const WorkState* state : all.states)
            if (const Look at = lookAt(*state); at.work != 0 && charged < busy) {
                charge(at, share);
                ++charged;
            }
        if (const double rest = since - share * charged; rest > 1e-12) charge({0, 0, 0}, rest);
    }

    Clock::duration untilNext() {
        return std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(untilNextLook(reading.seconds, spread)));
    }

    void run() {
        std::unique_lock lock(mutex);
        while (!changed.wait_for(lock, untilNext(), [this] { return stopping; })) look();
    }

    std::mutex mutex;
    std::condition_variable changed;
    bool stopping = false;
    const WorkState* owner = &workState;
    int threads = 1;
    Clock::time_point last = Clock::now();
    double spread = 0;
    WorkReading reading;
    std::thread thread;
};

WorkClock::WorkClock(int threads) : impl_(std::make_unique<Impl>()) {
    showWork();
    impl_->threads = std::max(threads, 1);
    try {
        impl_->thread = std::thread([this] { impl_->run(); });
    } catch (const std::system_error&) { // the reading then is all one charge
    }
}

WorkClock::~WorkClock() {
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->stopping = true;
    }
    impl_->changed.notify_all();
    if (impl_->thread.joinable()) impl_->thread.join();
}

WorkReading WorkClock::read() {
    const std::lock_guard lock(impl_->mutex);
    impl_->look();
    return impl_->reading;
}

} // namespace abbe
