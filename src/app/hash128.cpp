#include "app/hash128.h"

#include <fmt/format.h>

namespace abbe {

std::string Hash128::digits() const {
    return fmt::format("{:016x}{:016x}", static_cast<std::uint64_t>(state_ >> 64), static_cast<std::uint64_t>(state_));
}

} // namespace abbe
