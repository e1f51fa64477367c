#include "rendering/end_watch.h"

#include <chrono>
#include <system_error>

namespace abbe {

namespace {
using WatchClock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLookEvery{5};
} // namespace

EndWatch::EndWatch(const StopFlag* asked, double seconds) {
    if (!asked && !(seconds > 0)) return;
    try {
        thread_ = std::thread([this, asked, seconds] { run(asked, seconds); });
    } catch (const std::system_error&) { // see the header
    }
}

EndWatch::~EndWatch() {
    {
        const std::lock_guard lock(mutex_);
        gone_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void EndWatch::run(const StopFlag* asked, double seconds) {
    const auto begin = WatchClock::now();
    const auto timeIsOver = [&] {
        return seconds > 0 && std::chrono::duration<double>(WatchClock::now() - begin).count() >= seconds;
    };
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kLookEvery, [this] { return gone_; }))
        if ((asked && asked->load(std::memory_order_relaxed)) || timeIsOver()) {
            over_.store(true, std::memory_order_relaxed);
            return;
        }
}

} // namespace abbe
