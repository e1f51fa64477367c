// PNG output of display-encoded pictures.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

struct PngPicture {
    int width = 0, height = 0;
    std::span<const float> rgb; // interleaved, display-encoded; quantising clamps to 0 … 1 (NaN becomes 0)
    int bits = 8;               // 8 or 16 per component
    bool srgb = true;           // the values are sRGB-encoded: tagged so
    std::vector<std::pair<std::string, std::string>> texts = {}; // keyword (1 … 79 Latin-1 characters) and text
};

// The bytes of a file. Throws IoError if memory runs out.
std::vector<char> encodePng(const PngPicture&);

// The file appears under its name only when it is whole; on failure an older one is untouched. Throws IoError.
void writePng(const std::string& path, const PngPicture&);

} // namespace abbe
