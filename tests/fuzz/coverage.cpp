// Compiled without that flag itself.
#include "fuzz/coverage.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

extern "C" const char __executable_start; // of the linker: addresses without what the system adds

namespace {

constexpr std::size_t kPlaces = 1 << 16;
std::array<std::uint8_t, kPlaces> counts{}; // of this input
std::array<std::uint8_t, kPlaces> known{};  // how often at the most, in powers of two

} // namespace

extern "C" void __sanitizer_cov_trace_pc() {
    const auto at =
        static_cast<std::uintptr_t>(static_cast<const char*>(__builtin_return_address(0)) - &__executable_start);
    std::uint8_t& count = counts[(at ^ at >> 16) % kPlaces];
    if (count < 255) ++count;
}

namespace abbe::fuzz {

void beginCoverage() { counts.fill(0); }

bool foundNew() {
    bool found = false;
    for (std::size_t i = 0; i < kPlaces; ++i) {
        const auto level = static_cast<std::uint8_t>(std::bit_width(counts[i]));
        if (level <= known[i]) continue;
        known[i] = level;
        found = true;
    }
    return found;
}

} // namespace abbe::fuzz
