// OpenEXR images with several samples per pixel, each at a depth.
#pragma once

#include "io/exr_writer.h"

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

// Of such a file, or of any with those channels (ZBack may be missing) in its first part of the type deepscanline.
// Throws IoError.
DeepPicture readDeepExr(const std::string& path);

// The samples of each pixel put over each other: planes of the data window.
struct FlatPicture {
    std::vector<float> r, g, b, a;
};
FlatPicture flatten(const DeepPicture&);

} // namespace abbe
