// What happens at each vertex of a chain of delta interfaces.
#pragma once

#include <cstddef>
#include <cstdint>

namespace abbe {

enum class ChainEvent : std::uint8_t { reflection, transmission };

// One to three events, in the order in which a camera path meets them.
class ChainSignature {
  public:
    static constexpr int kMaxLength = 3;
    static constexpr std::size_t kCount = 14; // 2 + 4 + 8

    ChainSignature() = default; // no event yet
    // The signature with that index(). Requires index < kCount.
    static ChainSignature ofIndex(std::size_t index) {
        ChainSignature s;
        s.length_ = index < 2 ? 1 : index < 6 ? 2 : 3;
        s.bits_ = static_cast<std::uint8_t>(index + 2 - (1u << s.length_));
        return s;
    }
    // From letters R and T; anything else ends it. Requires at most kMaxLength.
    static ChainSignature of(const char* letters) {
        ChainSignature s;
        for (; *letters == 'R' || *letters == 'T'; ++letters)
            s.add(*letters == 'T' ? ChainEvent::transmission : ChainEvent::reflection);
        return s;
    }

    int length() const { return length_; }
    ChainEvent operator[](int i) const {
        return (bits_ >> (length_ - 1 - i)) & 1 ? ChainEvent::transmission : ChainEvent::reflection;
    }
    // Requires length() < kMaxLength.
    void add(ChainEvent event) {
        bits_ = static_cast<std::uint8_t>(2 * bits_ + (event == ChainEvent::transmission));
        ++length_;
    }
    // 0 … kCount - 1: the shorter ones first, reflection before transmission. Requires length() > 0.
    std::size_t index() const { return (1u << length_) - 2u + bits_; }
    bool operator==(const ChainSignature&) const = default;

  private:
    std::uint8_t length_ = 0, bits_ = 0; // the last event is the lowest bit
};

// Mirrored or let through, in the order in which a camera path meets it.
class GlintChain {
  public:
    static constexpr std::uint32_t kMaxLength = 16;

    GlintChain() = default; // no event yet
    // From letters R and T; anything else ends it. Requires at most kMaxLength.
    static GlintChain of(const char* letters) {
        GlintChain chain;
        for (; *letters == 'R' || *letters == 'T'; ++letters) chain.add(*letters == 'T');
        return chain;
    }

    std::uint32_t length() const { return length_; }
    // Requires i < length().
    bool transmits(std::uint32_t i) const { return (bits_ >> i) & 1; }
    // Beyond kMaxLength it is only known that the chain is longer: no plan has it.
    void add(bool transmission) {
        if (length_ < kMaxLength) bits_ |= std::uint32_t{transmission} << length_;
        if (length_ <= kMaxLength) ++length_;
    }
    auto operator<=>(const GlintChain&) const = default;

  private:
    std::uint32_t length_ = 0, bits_ = 0; // the first event is the lowest bit
};

} // namespace abbe
