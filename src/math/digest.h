// Fingerprints of what things are made of, by which those of equal making are found again.
#pragma once

#include "math/byte_hash.h"
#include "math/transform.h"

#include <compare>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace abbe {

// 128 bits. No defence against anyone who wants a collision.
struct Digest {
    std::uint64_t first = 0, second = 0;

    auto operator<=>(const Digest&) const = default;
};

// Takes what it is given in order; texts and lists with their lengths.
class DigestWriter {
  public:
    DigestWriter() { number(std::uint64_t{0x5bd1e995}, second_); }
    explicit DigestWriter(std::string_view what) : DigestWriter() { text(what); }

    void bytes(std::span<const std::byte> b) { first_.add(b), second_.add(b); }
    void text(std::string_view s) {
        number(s.size());
        bytes(std::as_bytes(std::span(s.data(), s.size())));
    }
    template <typename T>
    requires std::is_arithmetic_v<T>
    void number(T value) { number(value, first_), number(value, second_); }
    void add(const Digest& d) { number(d.first), number(d.second); }
    void add(Vec3d v) { number(v.x), number(v.y), number(v.z); }
    void add(const Transform& t) {
        for (const auto& row : t.a)
            for (const double v : row) number(v);
        add(t.t);
    }
    Digest digest() const { return {first_.value(), second_.value()}; }

  private:
    template <typename T> static void number(T value, ByteHash& hash) { hash.add(std::as_bytes(std::span(&value, 1))); }
    ByteHash first_, second_; // the second sees all of it shifted
};

} // namespace abbe
