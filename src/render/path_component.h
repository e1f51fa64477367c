// Which part of a picture a path belongs to.
#pragma once

#include <cstddef>
#include <cstdint>

namespace abbe {

// By what it meets between the light and the eye; D scatters diffusely or in a medium, S does not.
enum class PathComponent : std::uint8_t {
    direct,   // E S* D? L: at most one D, and no S between it and the light
    indirect, // more than one D
    caustic,  // E … D S+ L
};
inline constexpr std::size_t kPathComponents = 3;

} // namespace abbe
