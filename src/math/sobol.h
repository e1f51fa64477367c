// Owen-scrambled points of digital sequences as Sobol's are, eight dimensions to a register.
#pragma once

#include <bit>
#include <cstdint>

namespace abbe {

using UInt8 = std::uint32_t __attribute__((vector_size(32)));

inline constexpr int kSobolDimensions = 24;

// What each nibble of the index contributes to each dimension: the XOR of its bits' direction numbers, whose own bits
// are reversed because the Owen scramble below works from the low bits up [Burley2020]. Nibbles instead of single bits:
// eight loads whatever the index, where a loop over set bits mispredicts its end on every point.
struct SobolTable {
    alignas(64) std::uint32_t rows[8][16][kSobolDimensions];
};
// Dimensions 0 and 1, 4 and 5, 7 and 8, 9 and 10, … 13 and 14, 16 and 17, … 22 and 23 are (0, 2)-sequences, as Sobol's
// first two are [Paulin2021]; 0 to 3 and 6 are those of [Joe2008], and 6 and 15 stand alone.
extern const SobolTable kSobolTable;

inline std::uint32_t reverseBits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}
inline UInt8 reverseBits(UInt8 x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Laine and Karras' hash with Vegdahl's constants [Vegdahl2021]: on bit-reversed values a nested uniform (Owen)
// scramble. Word is std::uint32_t or UInt8.
template <typename Word> inline Word owenScrambleReversed(Word x, Word seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}
inline UInt8 mixLanes(UInt8 x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// The index in the order of an Owen-shuffled sequence: sets with different seeds become independent of each other
// (padding), while every aligned power-of-two block of one set stays a net.
inline std::uint32_t shuffleIndex(std::uint32_t index, std::uint32_t seed) {
    return reverseBits(owenScrambleReversed(reverseBits(index), seed));
}

// Eight dimensions from their unscrambled bits: Owen scramble, then 24-bit fractions in [0, 1).
inline void scrambleToFloats(UInt8 bits, UInt8 seeds, float* out) {
    using SignedInt8 = std::int32_t __attribute__((vector_size(32)));
    using Float8v = float __attribute__((vector_size(32)));
    bits = reverseBits(owenScrambleReversed(bits, seeds)) >> 8;
    *reinterpret_cast<Float8v*>(out) = __builtin_convertvector(reinterpret_cast<SignedInt8>(bits), Float8v) * 0x1p-24f;
}
inline UInt8 dimensionSeeds(std::uint32_t seed, int first) {
    const UInt8 lane = {1, 2, 3, 4, 5, 6, 7, 8};
    return mixLanes((UInt8{} + seed) ^ ((lane + static_cast<std::uint32_t>(first)) * 0x85ebca6bu));
}
// Dimensions [first, first + 8) of point `index` of the unscrambled sequence, bits reversed.
inline UInt8 sobolBits(std::uint32_t index, int first) {
    UInt8 bits = {};
#pragma GCC unroll 8
    for (int nibble = 0; nibble < 8; ++nibble, index >>= 4)
        bits ^= *reinterpret_cast<const UInt8*>(kSobolTable.rows[nibble][index & 15] + first);
    return bits;
}

// Dimensions [first, first + 8) of point `shuffled`, as 24-bit fractions in [0, 1). `out` is 32-byte aligned.
inline void scrambledSobol8(std::uint32_t shuffled, std::uint32_t seed, int first, float* out) {
    scrambleToFloats(sobolBits(shuffled, first), dimensionSeeds(seed, first), out);
}

// Sixteen joint dimensions of one point.
inline void scrambledSobol16(std::uint32_t index, std::uint32_t seed, float* out) {
    const std::uint32_t shuffled = shuffleIndex(index, seed);
    scrambledSobol8(shuffled, seed, 0, out);
    scrambledSobol8(shuffled, seed, 8, out + 8);
}

} // namespace abbe
