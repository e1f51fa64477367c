// A set of enumerators whose values are single bits.
#pragma once

#include <type_traits>

namespace abbe {

template <typename Enum> class Flags {
  public:
    using Bits = std::underlying_type_t<Enum>;

    constexpr Flags() = default;
    constexpr Flags(Enum e) : bits_(static_cast<Bits>(e)) {}

    constexpr bool has(Enum e) const { return (bits_ & static_cast<Bits>(e)) != 0; }
    constexpr bool any(Flags f) const { return (bits_ & f.bits_) != 0; }
    constexpr bool contains(Flags f) const { return (bits_ & f.bits_) == f.bits_; }
    constexpr bool empty() const { return bits_ == 0; }
    constexpr Bits bits() const { return bits_; }
    constexpr Flags operator|(Flags f) const { return fromBits(static_cast<Bits>(bits_ | f.bits_)); }
    constexpr Flags operator&(Flags f) const { return fromBits(static_cast<Bits>(bits_ & f.bits_)); }
    constexpr Flags& operator|=(Flags f) { return *this = *this | f; }
    constexpr bool operator==(const Flags&) const = default;
    static constexpr Flags fromBits(Bits b) {
        Flags f;
        f.bits_ = b;
        return f;
    }

  private:
    Bits bits_ = 0;
};

} // namespace abbe
