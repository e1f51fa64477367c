// Sums whose result does not depend on the order of the terms, nor on the threads that add them.
#pragma once

#include <atomic>
#include <cstdint>

namespace abbe {

// A fixed-point number of 128 bits with 72 of them behind the point: additions of integers commute and associate, so
// samples may be added by any thread, in any order, in parts that are put together later, and give the same bits.
// Resolves 2e-22 and holds sums up to 3.6e16; one term may be up to kLargest. Terms are rounded down to the resolution.
class ExactSum {
  public:
    // Exclusive bound of the magnitude of a term.
    static constexpr double kLargest = 4398046511104.0; // 2⁴²

    ExactSum() = default;
    // Requires |x| < kLargest.
    explicit ExactSum(double x) noexcept {
        // The upper 62 bits, then what is left, which is exact in double and in [0, 1).
        const double scaled = x * 0x1p20;
        auto upper = static_cast<std::int64_t>(scaled);
        upper -= static_cast<double>(upper) > scaled; // floor
        const auto lower = static_cast<std::int64_t>((scaled - static_cast<double>(upper)) * 0x1p52);
        value_ = (static_cast<Integer>(upper) << 52) + lower;
    }

    // Sums overflow beyond 3.6e16, which takes ten thousand of the largest terms.
    ExactSum& operator+=(ExactSum b) noexcept {
        value_ += b.value_;
        return *this;
    }
    ExactSum operator+(ExactSum b) const noexcept { return ExactSum(*this) += b; }
    bool operator==(const ExactSum&) const = default;

    // Rounded to nearest.
    double value() const noexcept { return static_cast<double>(value_) * 0x1p-72; }

    // For files.
    std::uint64_t high() const noexcept { return static_cast<std::uint64_t>(static_cast<Unsigned>(value_) >> 64); }
    std::uint64_t low() const noexcept { return static_cast<std::uint64_t>(value_); }
    static ExactSum ofBits(std::uint64_t high, std::uint64_t low) noexcept {
        ExactSum sum;
        sum.value_ = static_cast<Integer>((static_cast<Unsigned>(high) << 64) | low);
        return sum;
    }

  private:
    __extension__ using Integer = __int128;
    __extension__ using Unsigned = unsigned __int128;
    Integer value_ = 0;
};

// An exact sum that several threads add to at once.
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
