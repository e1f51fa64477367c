// Image files of any format that OpenImageIO reads: their headers, and whole images as float pixels.
#pragma once

#include "textures/image_module.h"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace abbe {

struct ImagePixels {
    int width = 0, height = 0, channels = 0; // 1 or 3
    std::vector<float> values;               // rows from the top, channels interleaved
    std::string colorSpace;                  // how the file is tagged, or empty
};

// What went wrong, to be shown to the user.
struct ImageFileError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Everywhere here: loads the module that reads images with the first call; it then stays. Throws ImageFileError.
const AbbeImageModule& imageModule();
// Also throws std::bad_alloc if the pixels do not fit into memory.
ImagePixels readImageFile(const std::string& path, int first = 0, int mostChannels = 3);
AbbeImageInfo describeImageFile(const std::string& path);
struct MemoryPicture {
    AbbePixels pixels;
    std::shared_ptr<const void> owner; // of the numbers
};
// The picture of arrays in memory (base/named_arrays.h), if `path` is the name of such: "pixels", size[0] × size[1] of
// size[2] channels, 1 to 4 of which the second or the fourth is alpha. No module is loaded.
std::optional<MemoryPicture> pixelsInMemory(const std::string& path);

} // namespace abbe
