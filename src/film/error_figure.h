// One way to say how far an image is from its limit, with what is known about that figure itself.
#pragma once

#include "render/film.h"

#include <cstdint>

namespace abbe {

struct ErrorFigure {
    double value = 0;         // root mean square over the pixels
    double low = 0, high = 0; // interval of 95 % for the error that this image has
    std::int64_t pixels = 0;  // with an estimate
    // The tile with the largest estimate of its own. Its value is less sure than that of the image.
    struct Tile {
        PixelBounds pixels;
        double value = 0;
    } worst;
    // How heavy the tail of the pixels' estimates is (TailEstimate): k of the Pareto distribution, and what is expected
    // of the squared error that no sample has met, over the squared error. `high` has room for it.
    double tail = 0, unseen = 0;
    // That were judged by themselves, and of them those whose own estimate lacks much.
    std::int64_t tiles = 0, untrustedTiles = 0;

    bool holds(double error) const { return low <= error && error <= high; }
};

} // namespace abbe
