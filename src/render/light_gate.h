// The way into a film for light paths, which whoever wants to see their sums at rest can close.
#pragma once

#include <mutex>
#include <shared_mutex>

namespace abbe {

// Many are inside at once; to close it is to wait for those inside and to let nobody else in meanwhile, so that threads
// which come and go without end cannot keep it open. A lock for each block of light paths would do as well, if threads
// could hold thousands of them.
class LightGate {
  public:
    using Pass = std::shared_lock<std::shared_mutex>;
    using Closure = std::unique_lock<std::shared_mutex>;

    // Both wait. A thread that is inside must not call either.
    [[nodiscard]] Pass enter() {
        const std::lock_guard turn(turnstile_);
        return Pass(inside_);
    }
    [[nodiscard]] Closure close() {
        const std::lock_guard turn(turnstile_);
        return Closure(inside_);
    }

  private:
    std::mutex turnstile_; // of those who wait for the other
    std::shared_mutex inside_;
};

} // namespace abbe
