// An exact sum that several threads add to at once.
#pragma once

#include "math/exact_sum.h"

#include <atomic>
#include <cstdint>

namespace abbe {

// Two words with the carry between them. Each is added to atomically, though not both at once: whoever reads while
// others add may see a low word without its carry. When all have ended the sum is right, in any order and on any
// thread, because every carry out of the low word was seen by exactly one of the additions.
class SharedSum {
  public:
    // From any thread.
    void add(ExactSum term) noexcept {
        using Word = std::atomic_ref<std::uint64_t>;
        const std::uint64_t low = term.low();
        const std::uint64_t before = Word(low_).fetch_add(low, std::memory_order_relaxed);
        const std::uint64_t high = term.high() + (before + low < low ? 1 : 0);
        if (high != 0) Word(high_).fetch_add(high, std::memory_order_relaxed);
    }

    // Requires, here and below, that nobody is adding.
    ExactSum sum() const noexcept { return ExactSum::ofBits(high_, low_); }
    double value() const noexcept { return sum().value(); }
    SharedSum& operator+=(const SharedSum& b) noexcept {
        const ExactSum total = sum() + b.sum();
        low_ = total.low();
        high_ = total.high();
        return *this;
    }
    bool operator==(const SharedSum&) const = default;

  private:
    std::uint64_t low_ = 0, high_ = 0;
};

} // namespace abbe
