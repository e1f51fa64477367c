// Jittered strata in the order of a random permutation, for any number of samples [Kensler2013].
#pragma once

#include "math/hash.h"
#include "math/vec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace abbe {

// The `i`-th element of a permutation of 0 … count - 1 that belongs to the key; for a random key each of them is
// equally likely, and so is each pair of two places, up to what hashing leaves. A Feistel network on as many bits as
// count - 1 has, repeated until the result is below `count`: that walks along a cycle of the network, so it permutes.
// Requires i < count.
inline std::uint32_t permuted(std::uint32_t i, std::uint32_t count, std::uint64_t key) {
    if (count < 2) return 0;
    constexpr int kRounds = 4;
    const int bits = std::bit_width(count - 1), low = bits / 2, high = bits - low;
    const std::uint32_t lowMask = (1u << low) - 1, highMask = (1u << high) - 1;
    std::uint64_t keys[kRounds];
    for (std::uint64_t& k : keys) k = key = mix64(key + 0x9e3779b97f4a7c15ull);
    do {
        std::uint32_t left = i >> low, right = i & lowMask;
        for (const std::uint64_t k : keys) {
            left ^= mix32(static_cast<std::uint32_t>(k) + right) & highMask;
            right ^= mix32(static_cast<std::uint32_t>(k >> 32) + left) & lowMask;
        }
        i = left << low | right;
    } while (i >= count);
    const std::uint64_t turn = mix64(key + 1) >> 32;
    return static_cast<std::uint32_t>((i + turn) % count);
}

// Sample `i` of a set of `count` in one dimension: each stratum of 1/count has one. Requires i < count.
inline float jittered(std::uint32_t i, std::uint32_t count, std::uint64_t key) {
    const double jitter = static_cast<double>(mix64(combine64(key, i)) >> 11) * 0x1p-53;
    const double stratum = permuted(i, count, key);
    return std::min(static_cast<float>((stratum + jitter) / count), kOneMinusEpsilon);
}

// The same in two: correlated multi-jittered points. The strata of a grid that is about square have one sample each,
// but for some in the last row where it has more cells than samples, and those of each dimension alone, count of the
// second and at least as many of the first, at most one.
inline Vec2 multiJittered(std::uint32_t i, std::uint32_t count, std::uint64_t key) {
    const auto columns = std::max(1u, static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count))));
    const std::uint32_t rows = (count + columns - 1) / columns;
    const std::uint32_t cell = permuted(i, count, key);
    const double column = permuted(cell % columns, columns, combine64(key, 1));
    const double row = permuted(cell / columns, rows, combine64(key, 2));
    const std::uint64_t jitter = mix64(combine64(key ^ 0xa0761d6478bd642full, i));
    const double jx = static_cast<double>(jitter >> 32) * 0x1p-32,
                 jy = static_cast<double>(jitter << 32 >> 32) * 0x1p-32;
    return {std::min(static_cast<float>((column + (row + jx) / rows) / columns), kOneMinusEpsilon),
            std::min(static_cast<float>((cell + jy) / count), kOneMinusEpsilon)};
}

} // namespace abbe
