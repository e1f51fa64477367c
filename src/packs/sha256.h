// SHA-256 as of FIPS 180-4 [Fips1804], so that anybody can check the files of a pack with `sha256sum`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace abbe {

class Sha256 {
  public:
    // In portions of any size.
    void add(std::span<const char> bytes);
    // 64 hexadecimal digits of all so far; more may be added later.
    std::string digits() const;

  private:
    void block(const unsigned char* bytes);

    std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<unsigned char, 64> rest_{}; // not yet a whole block
    std::uint64_t total_ = 0;              // bytes
};

} // namespace abbe
