// One job of a kernel, in parts that idle threads take.
#pragma once

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/work.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace abbe {

// Loops of one job, which belong to one caller, and what other threads spent in them.
class SharedWork {
  public:
    // Calls body(i) for every i in [0, count), each on some thread that is at the caller's work meanwhile
    // (base/work.h). The caller may hold locks.
    template <typename Body> void run(std::size_t count, Body&& body) {
        const std::thread::id caller = std::this_thread::get_id();
        const std::uint8_t work = workState.work.load(std::memory_order_relaxed);
        const std::uint8_t flags = workState.flags.load(std::memory_order_relaxed);
        parallelParts(count, [&](std::size_t i) {
            if (std::this_thread::get_id() == caller) return body(i);
            const WorkScope scope(static_cast<Work>(work));
            const std::uint8_t before = workState.flags.load(std::memory_order_relaxed);
            const double begun = threadSeconds();
            setWorkFlags(flags);
            body(i);
            setWorkFlags(before);
            const auto spent = static_cast<std::uint64_t>((threadSeconds() - begun) * 1e9);
            nanoseconds_.fetch_add(spent, std::memory_order_relaxed);
        });
    }

    double secondsElsewhere() const { return static_cast<double>(nanoseconds_.load(std::memory_order_relaxed)) * 1e-9; }

  private:
    std::atomic<std::uint64_t> nanoseconds_{0};
};

// What parts of a job need to be at work, kept from one part to the next: there are as many as were at work at once.
template <typename Tool> class ToolPool {
  public:
    // make(): a std::unique_ptr<Tool>; from any thread.
    template <typename Make> std::unique_ptr<Tool> take(Make&& make) {
        {
            const std::lock_guard lock(mutex_);
            if (!tools_.empty()) {
                std::unique_ptr<Tool> tool = std::move(tools_.back()); // which a cache may still have
                tools_.pop_back();
                return tool;
            }
        }
        return make();
    }
    void giveBack(std::unique_ptr<Tool> tool) {
        const std::lock_guard lock(mutex_);
        tools_.push_back(std::move(tool));
    }
    // When all have been given back.
    const std::vector<std::unique_ptr<Tool>>& all() const { return tools_; }

  private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<Tool>> tools_;
};

} // namespace abbe
