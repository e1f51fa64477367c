// A stable fingerprint of bytes for provenance; no defence against anyone who wants a collision.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace abbe {

// FNV-1a with 128 bits (offset basis and prime as published by its authors). The same bytes give the same digits on
// every machine and in every version.
class Hash128 {
  public:
    void add(std::string_view bytes) {
        for (const char c : bytes) {
            state_ ^= static_cast<unsigned char>(c);
            state_ *= kPrime;
        }
    }
    // With its length, so that ("ab", "c") and ("a", "bc") differ.
    void addField(std::string_view bytes) {
        add(std::to_string(bytes.size()));
        add(":");
        add(bytes);
    }
    // 32 hexadecimal digits.
    std::string digits() const;

  private:
    __extension__ using State = unsigned __int128;
    static constexpr State kPrime = static_cast<State>(0x1000000) << 64 | 0x13b;
    State state_ = static_cast<State>(0x6c62272e07bb0142) << 64 | 0x62b821756295c58d;
};

} // namespace abbe
