// Integer hashes for seeds. Pure functions: the whole image is one of scene and seed.
#pragma once

#include <cstdint>

namespace abbe {

// Bijective mixers; the 64-bit one is Stafford's variant 13 of the MurmurHash3 finaliser, the 32-bit one Wellons'
// lowbias32.
constexpr std::uint64_t mix64(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
constexpr std::uint32_t mix32(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}
// Order-dependent combination of two hashes.
constexpr std::uint64_t combine64(std::uint64_t a, std::uint64_t b) { return mix64(a * 0x9e3779b97f4a7c15ull + b); }

// 24 random bits as a float in [0, 1).
constexpr float unitFloat(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

} // namespace abbe
