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

    bool holds(double error) const { return low <= error && error <= high; }
};

} // namespace abbe
