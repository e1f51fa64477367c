// A fast fingerprint of many bytes, against damage and mistakes; no defence against anyone who wants a collision.
#pragma once

#include "math/hash.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>

namespace abbe {

// 64 bits over bytes that come in portions; the portions do not matter. Four lanes, because a multiplication takes
// longer than reading the next word; a round is that of xxHash64 [Collet2012].
class ByteHash {
  public:
    void add(std::span<const std::byte> bytes) {
        if (bytes.empty()) return;
        total_ += bytes.size();
        if (filled_ > 0) {
            const std::size_t taken = std::min(bytes.size(), sizeof rest_ - filled_);
            std::memcpy(rest_ + filled_, bytes.data(), taken);
            filled_ += taken;
            bytes = bytes.subspan(taken);
            if (filled_ < sizeof rest_) return;
            block(rest_);
            filled_ = 0;
        }
        for (; bytes.size() >= sizeof rest_; bytes = bytes.subspan(sizeof rest_)) block(bytes.data());
        if (!bytes.empty()) std::memcpy(rest_, bytes.data(), bytes.size());
        filled_ = bytes.size();
    }

    std::uint64_t value() const {
        ByteHash end = *this;
        std::memset(end.rest_ + filled_, 0, sizeof rest_ - filled_);
        end.block(end.rest_);
        std::uint64_t hash = total_;
        for (const std::uint64_t lane : end.lanes_) hash = combine64(hash, lane);
        return hash;
    }

  private:
    static constexpr std::size_t kLanes = 4;

    void block(const std::byte* bytes) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            std::uint64_t word;
            std::memcpy(&word, bytes + 8 * i, sizeof word);
            // Two multiplications: after one alone a change of the upper bits is undone by one in the next block.
            lanes_[i] = std::rotl(lanes_[i] + word * 0xc2b2ae3d27d4eb4full, 31) * 0x9e3779b185ebca87ull;
        }
    }

    std::uint64_t lanes_[kLanes] = {1, 2, 3, 4};
    std::byte rest_[8 * kLanes] = {}; // not yet a whole block
    std::size_t filled_ = 0;
    std::uint64_t total_ = 0;
};

inline std::uint64_t hashOf(std::span<const std::byte> bytes) {
    ByteHash hash;
    hash.add(bytes);
    return hash.value();
}

} // namespace abbe
