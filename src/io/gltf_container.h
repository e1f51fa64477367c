// The outside of glTF files, before any of it is interpreted.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace abbe {

struct GltfFault {
    std::size_t byte;
    std::string what;
};

bool isBinaryGltf(std::string_view bytes);

// Checks the header and the chunks of a binary file, and that the JSON nests less than 256 levels deep: the libraries
// that read it recurse.
std::optional<GltfFault> findContainerFault(std::string_view bytes);

} // namespace abbe
