// How the pixels of a square divide the strata of their joint dimensions among them.
#pragma once

#include "math/sobol.h"

#include <array>
#include <bit>
#include <cstdint>

namespace abbe {

// What each of the 4 × 4 pixels of a square adds to the digits of a point that all of them share, before its digits are
// scrambled alike for all. Each pixel then has a scrambled Sobol sequence as it would have by itself; together they
// have one point in each of as many strata as there are points, so that what the points of one pixel leave out its
// neighbours have, and the mean over the square errs less than pixels by themselves would have it [Ahmed2020].
//
// A digit is added where an odd number of the place's four bits are among those of its row: a digital shift, which
// keeps every net. Of any four rows in succession none is a sum of the others, hence the strata with any power of two
// of samples; which rows was found by search (docs/decisions/042-squares-of-pixels.md).
class PixelSquare {
  public:
    static constexpr int kSide = 4;

    // Place of a pixel in its square: x and y by turns, so that the first four are the first 2 × 2.
    static constexpr std::size_t place(int x, int y) {
        return static_cast<std::size_t>((x & 1) | (y & 1) << 1 | (x & 2) << 1 | (y & 2) << 2);
    }
    // Of dimensions 8 `group` and on, the highest digit in the lowest bit as sobolBits() has them.
    static UInt8 shift(std::size_t place, int group) {
        return *reinterpret_cast<const UInt8*>(kShifts.digits[place].data() + 8 * group);
    }
    // Of the number of the eighth that the hero is in.
    static std::uint32_t heroShift(std::size_t place) { return kShifts.hero[place]; }

  private:
    static constexpr int kDigits = 10; // 4 × 4 pixels with 32 samples have as many strata as 9 digits tell apart
    struct Shifts {
        alignas(32) std::array<std::array<std::uint32_t, kSobolDimensions>, kSide * kSide> digits{};
        std::array<std::uint32_t, kSide * kSide> hero{};
    };
    static constexpr Shifts shifts() {
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
            for (std::size_t digit = 0; digit < 3; ++digit)
                all.hero[place] |= odd(place, heroRows[digit]) << (2 - digit);
        }
        return all;
    }
    static const Shifts kShifts;
};

inline constexpr PixelSquare::Shifts PixelSquare::kShifts = PixelSquare::shifts();

} // namespace abbe
