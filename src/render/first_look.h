// A rough picture of the frame before the first sample.
#pragma once

#include "render/film.h"

#include <algorithm>
#include <vector>

namespace abbe {

class Shape;

// Paths that surfaces take no light from, so that chance alone ends them (PathWalk::longPathSurvival).
struct EndlessPaths {
    double share = 0; // of the paths where they are the longest
    std::vector<const Shape*>
        shapes; // between which they go, those that are met most often first; empty: there are none
};

// The frame in square cells, row by row, of a few samples each. For people to see while plans are made: no sample of it
// is in the image.
struct FirstLook {
    PixelBounds frame;
    int cellSize = 1; // pixels; cells at the right and lower borders may be cut
    int columns = 0, rows = 0;
    std::vector<Xyz> cells;
    double secondsForSample = 0; // of the clock, that a sample of every pixel of the frame takes, as far as this tells
    double raysOfPath = 0;       // in the mean over the frame
    EndlessPaths endless = {};

    // Of a pixel; beyond the frame, of the cell next to it. Requires a cell.
    const Xyz& at(int x, int y) const {
        const int column = std::clamp((x - frame.x0) / cellSize, 0, columns - 1);
        const int row = std::clamp((y - frame.y0) / cellSize, 0, rows - 1);
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
    }
};

} // namespace abbe
