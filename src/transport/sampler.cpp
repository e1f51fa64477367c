#include "transport/sampler.h"

#include "math/multi_jitter.h"

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

constinit const PixelSquare::Shifts PixelSquare::kShifts = [] {
    // clang-format off
    constexpr std::uint8_t rows[kSobolDimensions][kDigits] = {
        {10, 3, 5, 2, 15, 1, 11, 9, 5, 15}, // 0
        {7, 2, 9, 3, 14, 1, 6, 5, 14, 2}, // 1
        {10, 9, 14, 15, 13, 6, 1, 9, 13, 13}, // 2
        {15, 1, 3, 10, 13, 11, 5, 1, 9, 3}, // 3
        {7, 9, 3, 2, 13, 11, 5, 2, 15, 15}, // 4
        {2, 1, 14, 7, 10, 11, 14, 6, 2, 13}, // 5
        {15, 6, 3, 13, 7, 1, 2, 14, 11, 15}, // 6
        {1, 6, 9, 2, 5, 15, 1, 12, 11, 10}, // 7
        {2, 11, 1, 6, 9, 2, 7, 1, 15, 8}, // 8
        {6, 9, 14, 13, 2, 7, 14, 1, 13, 12}, // 9
        {13, 3, 9, 6, 7, 5, 11, 8, 7, 5}, // 10
        {1, 10, 15, 9, 14, 13, 15, 4, 5, 3}, // 11
        {6, 9, 11, 10, 13, 14, 5, 9, 6, 11}, // 12
        {2, 1, 7, 10, 15, 14, 3, 11, 1, 15}, // 13
        {13, 10, 3, 2, 13, 11, 5, 2, 3, 5}, // 14
        {6, 3, 10, 1, 14, 3, 6, 7, 15, 7}, // 15
        {15, 5, 14, 13, 15, 6, 7, 12, 8, 6}, // 16
        {13, 3, 10, 15, 13, 6, 1, 15, 2, 10}, // 17
        {2, 15, 9, 10, 11, 6, 9, 5, 11, 2}, // 18
        {10, 3, 13, 15, 5, 14, 7, 8, 12, 3}, // 19
        {10, 13, 14, 11, 10, 13, 2, 11, 5, 10}, // 20
        {5, 2, 9, 3, 5, 2, 15, 3, 7, 4}, // 21
        {9, 15, 1, 10, 7, 5, 11, 15, 7, 13}, // 22
        {11, 9, 3, 14, 5, 7, 13, 3, 8, 13}, // 23
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
