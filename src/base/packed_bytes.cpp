#include "base/packed_bytes.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <immintrin.h>

namespace abbe {

namespace {

constexpr std::size_t kWord = sizeof(std::uint64_t);

// For each byte of flags the bytes that it stands for.
constexpr std::array<std::uint64_t, 256> kBytesOfFlags = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::size_t flags = 0; flags < table.size(); ++flags)
        for (unsigned bit = 0; bit < kWord; ++bit)
            if (flags >> bit & 1) table[flags] |= std::uint64_t{0xff} << (8 * bit);
    return table;
}();

// Which bytes are not zero.
unsigned flagsOf(std::uint64_t word) {
    const __m128i zero = _mm_cmpeq_epi8(_mm_cvtsi64_si128(static_cast<long long>(word)), _mm_setzero_si128());
    return ~static_cast<unsigned>(_mm_movemask_epi8(zero)) & 0xff;
}

// Processors that move bytes by a mask take eight words at a time, three to five times as fast: as many as are whole.
// The rest is for the code of all others.
constexpr std::size_t kWords = 8, kBytes = kWords * kWord;
#define ABBE_BYTE_MASKS __attribute__((target("avx512f,avx512bw,avx512vbmi2,popcnt")))
const bool kHasByteMasks = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vbmi2");

// How many words of `to` were made, fewer where bytes are missing; `at`: how many bytes of `from` are in them.
ABBE_BYTE_MASKS std::size_t spread(const std::byte* flags, std::span<const std::byte> from, std::span<std::byte> to,
                                   std::size_t& at) {
    std::size_t i = 0;
    for (; (i + kWords) * kWord <= to.size(); i += kWords) {
        std::uint64_t mask;
        std::memcpy(&mask, flags + i, sizeof mask);
        const std::size_t left = from.size() - at;
        const auto count = static_cast<std::size_t>(_mm_popcnt_u64(mask));
        if (count > left) break;
        const __mmask64 there = left < kBytes ? (__mmask64{1} << left) - 1 : ~__mmask64{0};
        const __m512i kept = _mm512_maskz_loadu_epi8(there, from.data() + at);
        _mm512_storeu_si512(to.data() + i * kWord, _mm512_maskz_expand_epi8(mask, kept));
        at += count;
    }
    return i;
}

// How many words of `from` were taken; `to`: behind what was kept of them. Requires room for all of their bytes.
ABBE_BYTE_MASKS std::size_t gather(std::span<const std::byte> from, std::byte* flags, std::byte*& to) {
    std::size_t i = 0;
    for (; (i + kWords) * kWord <= from.size(); i += kWords) {
        const __m512i bytes = _mm512_loadu_si512(from.data() + i * kWord);
        const std::uint64_t mask = _mm512_test_epi8_mask(bytes, bytes);
        std::memcpy(flags + i, &mask, sizeof mask);
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi8(mask, bytes));
        to += _mm_popcnt_u64(mask);
    }
    return i;
}

} // namespace

void appendPacked(std::span<const std::byte> bytes, std::vector<std::byte>& out) {
    const std::size_t words = (bytes.size() + kWord - 1) / kWord, begin = out.size();
    out.resize(begin + words * (1 + kWord));
    std::byte* flagsTo = out.data() + begin;
    std::byte* to = flagsTo + words;
    for (std::size_t i = kHasByteMasks ? gather(bytes, flagsTo, to) : 0; i < words; ++i) {
        std::uint64_t word = 0;
        const std::size_t at = i * kWord;
        std::memcpy(&word, bytes.data() + at, std::min(kWord, bytes.size() - at));
        const unsigned flags = flagsOf(word);
        flagsTo[i] = static_cast<std::byte>(flags);
        const std::uint64_t packed = _pext_u64(word, kBytesOfFlags[flags]);
        std::memcpy(to, &packed, kWord); // there is room; what is behind the last one is written over
        to += std::popcount(flags);
    }
    out.resize(static_cast<std::size_t>(to - out.data()));
}

bool unpack(std::span<const std::byte> packed, std::size_t size, std::vector<std::byte>& out) {
    const std::size_t words = size / kWord + (size % kWord != 0);
    if (words > packed.size()) return false; // each takes one byte at least
    out.resize(words * kWord);
    const std::byte* const flagsFrom = packed.data();
    const std::span<const std::byte> from = packed.subspan(words);
    std::size_t at = 0;
    std::size_t i = kHasByteMasks ? spread(flagsFrom, from, out, at) : 0;
    const auto put = [&](std::uint64_t kept, unsigned flags) {
        const std::uint64_t word = _pdep_u64(kept, kBytesOfFlags[flags]);
        std::memcpy(out.data() + i * kWord, &word, kWord);
    };
    // Where eight bytes are left none need be counted, for those that are too many are not used.
    for (; i < words && at + kWord <= from.size(); ++i) {
        const auto flags = static_cast<unsigned>(flagsFrom[i]);
        std::uint64_t kept = 0;
        std::memcpy(&kept, from.data() + at, kWord);
        put(kept, flags);
        at += static_cast<std::size_t>(std::popcount(flags));
    }
    for (; i < words; ++i) {
        const auto flags = static_cast<unsigned>(flagsFrom[i]);
        const auto count = static_cast<std::size_t>(std::popcount(flags));
        if (count > from.size() - at) return false;
        std::uint64_t kept = 0;
        if (count > 0) std::memcpy(&kept, from.data() + at, count);
        put(kept, flags);
        at += count;
    }
    for (std::size_t behind = size; behind < out.size(); ++behind)
        if (out[behind] != std::byte{}) return false;
    out.resize(size);
    return at == from.size();
}

} // namespace abbe
