// OpenEXR images with several samples per pixel, each at a depth.
#pragma once

#include "io/exr_writer.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace abbe {

// Scan lines of deep samples, premultiplied, by rising depth; samples of a pixel do not overlap.
struct DeepPicture {
    PixelWindow window, display;
    std::vector<std::uint32_t> counts;       // of each pixel of the data window, row by row from the top
    std::vector<float> z, zBack, a, r, g, b; // of all samples, pixel by pixel
    std::optional<Chromaticities> chromaticities;
    std::optional<Chromaticity> adoptedNeutral; // their white, if not given
    std::vector<ImageAttribute> attributes = {};
};

// Channels A R G B Z ZBack, all float, zips: one part of the type deepscanline. The file appears under its name only
// when it is whole; on failure an older one is untouched. Throws IoError.
void writeDeepExr(const std::string& path, const DeepPicture&);

// The same row by row: `write` gives all rows, some whole ones at a time from the top, to the function that it gets: a
// picture whose window they are. Of `head` everything counts but the samples. Throws also what `write` throws.
using DeepRows = std::function<void(const DeepPicture&)>;
void writeDeepExr(const std::string& path, const DeepPicture& head, const std::function<void(const DeepRows&)>& write);

// Of such a file, or of any with those channels (ZBack may be missing) in its first part of the type deepscanline.
// Throws IoError, also if it has more samples than `most`.
DeepPicture readDeepExr(const std::string& path, std::size_t most = SIZE_MAX);

// The samples of each pixel put over each other: planes of the data window.
struct FlatPicture {
    std::vector<float> r, g, b, a;
};
FlatPicture flatten(const DeepPicture&);

} // namespace abbe
