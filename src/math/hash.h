// Integer hashes for seeds, and random numbers made of them. Pure functions: the whole image is one of scene and seed.
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>

namespace abbe {

// Bijective mixers; the 64-bit one is Stafford's variant 13 of the MurmurHash3 finaliser, the 32-bit one Wellons'
// lowbias32.
constexpr std::uint64_t mix64(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
template <typename Bits> constexpr Bits mix32(Bits x) { // of 32 bits, or a vector of such
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}
// Order-dependent combination of two hashes.
constexpr std::uint64_t combine64(std::uint64_t a, std::uint64_t b) { return mix64(a * 0x9e3779b97f4a7c15ull + b); }

// 24 random bits as a float in [0, 1).
constexpr float unitFloat(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

// Independent random numbers without an end, for what may need any number of them.
// SplitMix64 [Steele2014]: a pure function of its seed.
class RandomStream {
  public:
    explicit RandomStream(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() { return mix64(state_ += 0x9e3779b97f4a7c15ull); }
    float uniform() { return unitFloat(static_cast<std::uint32_t>(bits() >> 32)); } // [0, 1)
    // Exponentially distributed with mean 1, up to 44. x = n ln 2 + y: e^-x has halved n times, which the leading zeros
    // of a random number count, and y in [0, ln 2) follows from the digits behind its first one. So x keeps all digits
    // of float next to 0, where -ln u would come in steps of 6e-8 (docs/hard_cases.md, cases 63 and 64).
    float exponential() { return exponentialOf(bits()); }
    static float exponentialOf(std::uint64_t b) {
        const int halved = std::countl_zero(b | 1);
        const float r = static_cast<float>(static_cast<std::int64_t>(((b << halved) << 1) >> 1)) * 0x1p-64f; // < 1/2
        const float z = r / (2 - r), z2 = z * z; // -ln(1 - r) = 2 artanh z, z <= 1/3; error below 2e-8 of it
        float odd = 1.f / 13;
        for (const float c : {1.f / 11, 1.f / 9, 1.f / 7, 1.f / 5, 1.f / 3, 1.f}) odd = odd * z2 + c;
        return static_cast<float>(halved) * 0.693147181f + 2 * z * odd;
    }

  private:
    std::uint64_t state_;
};

} // namespace abbe
