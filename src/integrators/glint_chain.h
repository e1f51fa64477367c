// What happens at each vertex of a path over nothing but delta interfaces, however long.
#pragma once

#include <cstdint>

namespace abbe {

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
