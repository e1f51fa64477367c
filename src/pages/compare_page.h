// One HTML page that shows images beside each other: wipe, flip, differences, exposure, pixel probe. It needs no server
// and loads nothing: the linear values of all images are in it, in single precision.
#pragma once

#include "io/image.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

// Views on data that the caller owns.
struct ComparePage {
    struct Image {
        std::string name, path;  // short and whole
        char key = 'A';          // on the keyboard, A … Z but not D, F, P, S, W
        const RgbImage* picture; // all of one size, at least two
    };
    struct Map {
        std::size_t image = 0;         // whose difference it is
        std::span<const float> values; // 0 … 1 for each pixel
    };
    struct Figure {
        std::string label;
        std::vector<std::string> values; // for the first images
    };

    std::string title;
    std::vector<Image> images; // the reference last
    std::vector<Map> maps;
    std::vector<Figure> figures;
    std::string verdict;
};

// A page has at most so many pixels of each image; larger images are shown as means of blocks.
inline constexpr std::uint64_t kMaxPagePixels = std::uint64_t(1) << 21;
// The side of those blocks: 1 for images that fit.
int pageBlock(int width, int height);

// The file appears under its name only when it is complete. Throws IoError.
void writeComparePage(const std::string& path, const ComparePage&);

} // namespace abbe
