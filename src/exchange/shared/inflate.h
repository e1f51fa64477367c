// Data that was compressed by deflate. Only here: zlib.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace abbe::exchange {

enum class Packing : std::uint8_t { zlib, gzip };

struct Inflated {
    enum class End : std::uint8_t { whole, damaged, tooLarge } end = End::damaged;
    std::string bytes; // as far as it went
};

// Stops soon after `most` bytes: a few could ask for any amount of memory.
Inflated inflated(std::string_view packed, Packing, std::uint64_t most);

} // namespace abbe::exchange
