// All frames of an animation in one picture.
#pragma once

#include "pictures/byte_picture.h"

#include <cstddef>
#include <vector>

namespace abbe {

// Where the tiles of a sheet are, px: as many columns as make it about 16:9, tiles no larger than their frames or 320
// px, and smaller where the sheet would be more than 4096 px wide or high.
struct SheetPlan {
    int columns = 0, rows = 0;
    int tileWidth = 0, tileHeight = 0;
    int gap = 0;
    int strip = 0; // below each tile, for its number; 0: there is no room for numbers

    // `longest`: digits of a number.
    static SheetPlan of(std::size_t frames, int frameWidth, int frameHeight, int longest);
    int width() const { return columns * (tileWidth + gap) + gap; }
    int height() const { return rows * (tileHeight + strip + gap) + gap; }
    int left(std::size_t position) const { return gap + static_cast<int>(position) % columns * (tileWidth + gap); }
    int top(std::size_t position) const {
        return gap + static_cast<int>(position) / columns * (tileHeight + strip + gap);
    }
};

// Memory of the sheet alone, however many frames there are.
class ContactSheet {
  public:
    // Of frames with these numbers, in this order; the size is that of the first one that is there.
    ContactSheet(std::vector<int> numbers, int frameWidth, int frameHeight);

    void put(std::size_t position, const BytePicture& frame);
    // A gap with a cross. Places that nothing was said of stay empty.
    void fail(std::size_t position);

    const SheetPlan& plan() const { return plan_; }
    const BytePicture& picture() const { return picture_; }

  private:
    void fill(int left, int top, int width, int height, unsigned char grey);
    void label(std::size_t position);

    std::vector<int> numbers_;
    SheetPlan plan_;
    BytePicture picture_;
};

} // namespace abbe
