// What went wrong in the lookups of a texture while rendering.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

namespace abbe {

// Counts from many threads; nothing happens to it as long as all is well.
class LookupFaults {
  public:
    enum Kind { coordinates, missingTile, failedRead, notFinite };

    void add(Kind kind) noexcept { counts_[kind].fetch_add(1, std::memory_order_relaxed); }
    std::uint64_t count(Kind kind) const noexcept { return counts_[kind].load(std::memory_order_relaxed); }
    bool unreadable() const noexcept { return unreadable_.load(std::memory_order_relaxed); }
    // True for the first caller alone, who is to say why.
    bool firstUnreadable() noexcept { return !unreadable_.exchange(true, std::memory_order_relaxed); }
    void say(std::string text) {
        const std::lock_guard lock(mutex_);
        example_ = std::move(text);
    }
    std::string example() const {
        const std::lock_guard lock(mutex_);
        return example_;
    }

  private:
    std::atomic<std::uint64_t> counts_[4] = {};
    std::atomic<bool> unreadable_ = false;
    mutable std::mutex mutex_;
    std::string example_; // why tiles could not be read
};

} // namespace abbe
