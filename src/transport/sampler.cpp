#include "transport/sampler.h"

#include "math/multi_jitter.h"

#include <algorithm>
#include <array>
#include <span>

namespace abbe {

namespace {

// Dimensions that are stratified together.
struct Strata {
    std::uint8_t first, width;
};
// In the order of the joint dimensions (sampler.h): places and directions are pairs.
constexpr std::array<Strata, 16> kJointStrata{{{0, 2},
                                               {2, 2},
                                               {4, 2},
                                               {6, 1},
                                               {7, 2},
                                               {9, 2},
                                               {11, 2},
                                               {13, 2},
                                               {15, 1},
                                               {16, 2},
                                               {18, 1},
                                               {19, 1},
                                               {20, 1},
                                               {21, 1},
                                               {22, 1},
                                               {23, 1}}};
constexpr std::array<Strata, 4> kSetStrata{{{0, 2}, {2, 2}, {4, 1}, {5, 1}}};

constexpr int kDigits = 10; // 4 × 4 pixels with 32 samples have as many strata as 9 digits tell apart

} // namespace

constinit const std::array<std::uint8_t, 24> PixelSquare::kOrders = [] {
    std::array<std::uint8_t, 4> order{0, 1, 2, 3};
    std::array<std::uint8_t, 24> all{};
    for (std::uint8_t& packed : all) {
        for (std::size_t i = 0; i < 4; ++i) packed = static_cast<std::uint8_t>(packed | order[i] << (2 * i));
        std::next_permutation(order.begin(), order.end());
    }
    return all;
}();

constinit const PixelSquare::Shifts PixelSquare::kShifts = [] {
    // clang-format off
    constexpr std::uint8_t rows[kSobolDimensions][kDigits] = {
        {3, 5, 14, 7, 13, 2, 3, 6, 12, 12}, // 0
        {9, 7, 6, 5, 15, 2, 9, 5, 15, 6}, // 1
        {7, 6, 5, 10, 11, 9, 6, 12, 4, 14}, // 2
        {10, 15, 1, 3, 9, 6, 13, 14, 15, 14}, // 3
        {1, 10, 7, 14, 11, 13, 15, 14, 7, 3}, // 4
        {14, 11, 6, 1, 3, 9, 6, 2, 3, 11}, // 5
        {15, 6, 3, 13, 7, 1, 2, 14, 11, 15}, // 6
        {2, 15, 6, 7, 10, 9, 11, 14, 4, 9}, // 7
        {7, 1, 11, 2, 15, 1, 7, 5, 14, 11}, // 8
        {13, 6, 7, 2, 9, 3, 5, 4, 13, 3}, // 9
        {2, 5, 6, 13, 10, 9, 15, 11, 3, 1}, // 10
        {3, 13, 6, 15, 10, 11, 2, 14, 10, 14}, // 11
        {9, 15, 14, 13, 10, 15, 14, 3, 10, 4}, // 12
        {10, 15, 13, 6, 7, 14, 11, 4, 6, 15}, // 13
        {11, 6, 5, 10, 11, 9, 14, 13, 11, 14}, // 14
        {5, 11, 13, 15, 1, 10, 9, 4, 8, 2}, // 15
        {9, 6, 3, 14, 9, 2, 3, 15, 8, 4}, // 16
        {14, 13, 15, 9, 14, 5, 10, 9, 14, 9}, // 17
        {3, 5, 11, 10, 13, 15, 1, 8, 5, 14}, // 18
        {2, 15, 9, 10, 13, 15, 1, 9, 3, 12}, // 19
        {13, 14, 5, 7, 6, 9, 3, 14, 6, 10}, // 20
        {9, 7, 10, 1, 3, 6, 9, 4, 1, 6}, // 21
        {2, 7, 14, 13, 2, 9, 14, 10, 15, 12}, // 22
        {3, 13, 7, 2, 11, 1, 15, 3, 4, 14}, // 23
    };
    // clang-format on
    constexpr std::uint8_t heroRows[] = {11, 13, 7};
    const auto odd = [](std::size_t place, std::uint8_t row) {
        return static_cast<std::uint32_t>(std::popcount(place & row) & 1);
    };
    Shifts all;
    for (std::size_t place = 0; place < all.hero.size(); ++place) {
        for (std::size_t d = 0; d < kSobolDimensions; ++d)
            for (std::size_t digit = 0; digit < kDigits; ++digit)
                all.digits[place][d] |= odd(place, rows[d][digit]) << digit;
        for (std::size_t digit = 0; digit < 3; ++digit) all.hero[place] |= odd(place, heroRows[digit]) << (2 - digit);
    }
    return all;
}();

void Sampler::fillOther(std::uint32_t set, bool joint, float* out) const {
    if (numbers_ == Technique::Numbers::random) return fillRandom(set, out, joint ? 24 : 8);
    const std::uint64_t key = combine64(combine64(stream_ ^ 0x6a09e667u, index_ / strata_), set);
    const std::uint32_t place = index_ % strata_;
    for (const Strata s : joint ? std::span<const Strata>(kJointStrata) : std::span<const Strata>(kSetStrata)) {
        const std::uint64_t own = combine64(key, s.first + 1u);
        if (s.width == 1) {
            out[s.first] = jittered(place, strata_, own);
            continue;
        }
        const Vec2 pair = multiJittered(place, strata_, own);
        out[s.first] = pair.x;
        out[s.first + 1] = pair.y;
    }
}

void Sampler::fillRandom(std::uint32_t set, float* out, int count) const {
    std::uint64_t state = combine64(stream_, (std::uint64_t{index_} << 32) | set);
    for (int i = 0; i < count; ++i) {
        state += 0x9e3779b97f4a7c15ull; // SplitMix64
        out[i] = unitFloat(static_cast<std::uint32_t>(mix64(state) >> 32));
    }
}

} // namespace abbe
