// What files and reports say of where they come from: this program, for --version and for the headers of images; the
// machine and this process; and a stable fingerprint of bytes, which is no defence against anyone who wants a
// collision.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace abbe {

inline constexpr int kLanguageEdition = 1;

// "0.1.0": that of the project in CMakeLists.txt.
std::string versionNumber();
// The text of --version: version, edition and what it was built with, without a line end.
std::string versionText();

std::string processorName(); // as the system tells it; empty if it does not
std::uint64_t peakMemory();  // bytes of this process so far

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
