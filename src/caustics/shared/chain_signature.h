// What happens at each vertex of a chain of delta interfaces.
#pragma once

#include <compare>
#include <cstdint>

namespace abbe {

enum class ChainEvent : std::uint8_t { reflection, transmission };

constexpr ChainEvent chainEvent(bool transmits) {
    return transmits ? ChainEvent::transmission : ChainEvent::reflection;
}

// Events of the longest chains that manifold sampling follows (ManifoldKinds).
inline constexpr int kLongestManifoldChain = 3;

// Events in the order in which a camera path hits them.
class ChainSignature {
  public:
    static constexpr int kMaxLength = 16;

    ChainSignature() = default; // no event yet
    // From letters R and T; anything else ends it. Requires at most kMaxLength.
    static ChainSignature of(const char* letters) {
        ChainSignature s;
        for (; *letters == 'R' || *letters == 'T'; ++letters) s.add(chainEvent(*letters == 'T'));
        return s;
    }

    int length() const { return static_cast<int>(length_); }
    // Requires 0 <= i < min(length(), kMaxLength).
    ChainEvent operator[](int i) const { return chainEvent((bits_ >> i) & 1); }
    // Beyond kMaxLength it is only known that the chain is longer: no plan has it.
    void add(ChainEvent event) {
        if (length_ < kMaxLength) bits_ |= static_cast<std::uint32_t>(event) << length_;
        if (length_ <= kMaxLength) ++length_;
    }
    auto operator<=>(const ChainSignature&) const = default;

  private:
    std::uint32_t length_ = 0, bits_ = 0; // the first event is the lowest bit
};

} // namespace abbe
