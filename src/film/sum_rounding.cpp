#include "film/sum_rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {

namespace {

// One value of a picture and its parts.
class Rounding {
  public:
    Rounding(const Partition& parts, std::size_t i) : parts_(parts), i_(i) {}

    float magnitude() const {
        float total = 0;
        for (const auto& part : parts_) total += std::abs(part[i_]);
        return total;
    }
    bool sound(float whole) const { return std::abs(sum() - whole) <= 2e-6f * std::max(magnitude(), std::abs(whole)); }

    // What is added last misses least; where its steps are too coarse, one before it is moved. What is 0 stays so.
    bool reach(float whole) {
        if (sum() == whole) return true;
        for (std::size_t k = parts_.size(); k-- > 0;)
            if (parts_[k][i_] != 0 && reachBy(parts_[k][i_], whole)) return true;
        return false;
    }

    // All to multiples of `step`, among which sums are exact in any order. Requires a whole that is one, too, and sums
    // of magnitudes below 2²⁴ steps.
    void quantise(float whole, float step) {
        float* largest = &parts_[0][i_];
        for (const auto& part : parts_) {
            part[i_] = std::nearbyint(part[i_] / step) * step;
            if (std::abs(part[i_]) > std::abs(*largest)) largest = &part[i_];
        }
        *largest += whole - sum();
    }

  private:
    float sum() const {
        float total = 0;
        for (const auto& part : parts_) total += part[i_];
        return total;
    }

    bool reachBy(float& part, float whole) {
        const float before = part;
        constexpr float kInfinite = std::numeric_limits<float>::infinity();
        for (int attempt = 0; attempt < 8; ++attempt) {
            const float left = whole - sum();
            if (left == 0) return true;
            // Every other time by the last bit of the part: a sum that lies halfway between two floats goes to the even
            // one, whatever is added in whole bits of the sum.
            const float moved = part + left;
            part = attempt % 2 == 0 && moved != part ? moved : std::nextafter(part, left > 0 ? kInfinite : -kInfinite);
        }
        part = before;
        return false;
    }

    const Partition& parts_;
    std::size_t i_;
};

} // namespace

std::size_t roundToSum(std::span<float> whole, std::span<const Partition> partitions) {
    std::size_t missed = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::vector<Rounding> roundings;
        for (const Partition& parts : partitions) roundings.emplace_back(parts, i);
        if (!std::ranges::all_of(roundings, [&](const Rounding& r) { return r.sound(whole[i]); })) {
            ++missed;
            continue;
        }
        if (std::ranges::all_of(roundings, [&](Rounding& r) { return r.reach(whole[i]); })) continue;
        float largest = std::abs(whole[i]);
        for (const Rounding& r : roundings) largest = std::max(largest, r.magnitude());
        const float step = std::ldexp(1.f, std::ilogb(largest) - 22);
        whole[i] = std::nearbyint(whole[i] / step) * step;
        for (Rounding& r : roundings) r.quantise(whole[i], step);
    }
    return missed;
}

} // namespace abbe
