// Pages of HTML that need no server and load nothing. That of `abbe compare` shows images beside each other: wipe,
// flip, differences, exposure, pixel probe; the linear values of all images are in it, in single precision. That of
// `abbe study` has findings in words, plots of error against time and samples, tables, pictures at equal time, the cost
// report and the effects; it is drawn in the browser by the scripts of pages/data/study_page, which are part of the
// page as the data are.
#pragma once

#include "io/image.h"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

// In one line, padded with `=`.
std::string base64(std::span<const unsigned char> bytes);
// For text and for attributes in quotes.
std::string htmlEscaped(std::string_view text);
// JSON inside a script element, which would end at the first "</script" of any text in it.
std::string scriptEscaped(std::string_view json);

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

// `json` is a study ("abbe-study/1"); whatever is absent or null in it is left out of the page. It is written into the
// page as it stands, so that the page saves the same figures.
std::string studyPage(std::string_view json);

} // namespace abbe
