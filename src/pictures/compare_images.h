// The images of `abbe compare`: pixels, and variances where the file has them.
#pragma once

#include "io/image.h"
#include "io/image_compare.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

struct CompareImage {
    std::string path;
    RgbImage picture;
    std::vector<float> variance; // of the luminance of each pixel; empty if unknown
    int replicates = 2;          // behind each variance
    double rounding = 0;         // relative, of stored values

    // OpenEXR or Radiance. Throws IoError.
    static CompareImage read(const std::string& path);
    // The mean of images of one size; their variances shrink accordingly.
    static CompareImage mean(std::span<const CompareImage>);

    std::vector<float> luminance() const; // as the chromaticities define it
};

// Nothing if either image has no variances. Requires equal sizes.
std::optional<TileTest> tileTest(const CompareImage& image, const CompareImage& reference);

} // namespace abbe
