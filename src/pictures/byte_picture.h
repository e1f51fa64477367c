// Pictures as a display shows them, of a byte each for red, green and blue.
#pragma once

#include "pictures/display_view.h"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

struct BytePicture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb; // interleaved, row by row from the top

    unsigned char* at(int x, int y) {
        return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
    }
    const unsigned char* at(int x, int y) const { return const_cast<BytePicture*>(this)->at(x, y); }
};

// Shows EXRs through a view.
class ExrViewer {
  public:
    explicit ExrViewer(ViewOptions options) : options_(std::move(options)) {}

    // Without what lies beyond the edges of the picture: the bytes that `abbe convert` writes. Throws IoError.
    BytePicture read(const std::string& path);
    // Of the image that was read last. Requires one.
    const DisplayView& view() const { return *view_; }

  private:
    ViewOptions options_;
    std::unique_ptr<const DisplayView> view_; // of one space, which seldom changes
    OutputSpace space_ = OutputSpace::aces2065_1;
};

// Of another size: each pixel is the mean of the area that it covers, of display values.
BytePicture resized(const BytePicture&, int width, int height);

// The size of a picture that is made to fit into a rectangle, with its shape; at least a pixel each way.
struct FittedSize {
    int width = 0, height = 0;
};
FittedSize fitInto(int width, int height, int mostWidth, int mostHeight);
// Amid black.
BytePicture fitted(const BytePicture&, int width, int height);

} // namespace abbe
