// Squares that a picture is worked on in.
#pragma once

#include <functional>

namespace abbe {

// Columns x0 … x0 + width − 1; the width is a multiple of kLanes, so that the last columns may lie beyond the edge.
struct Tile {
    static constexpr int kSize = 32;

    int x0 = 0, y0 = 0, width = 0, height = 0;
};

// Calls body for every tile of a picture, from many threads, in four rounds: tiles of one round are at least kSize
// pixels apart, so that a body may add to what lies up to 12 pixels outside its tile. The order of what is added at one
// pixel is that of the rounds; sums have the same bits for any number of threads.
void forEachTile(int width, int height, const std::function<void(const Tile&)>& body);

} // namespace abbe
