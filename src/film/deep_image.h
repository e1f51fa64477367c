// From the sums of depths to the samples of a deep image.
#pragma once

#include "film/layer_planes.h"

namespace abbe {

// Premultiplied samples by rising distance, which do not overlap: a surface is at one, a medium fills the space from
// one to another. Put over each other in this order they are the picture, but for light that comes from no distance,
// that of the sky and what light paths brought.
struct DeepImage {
    PixelBounds bounds;
    std::vector<std::uint32_t> counts;          // of each pixel, row by row from the top
    std::vector<float> front, back, a, r, g, b; // of all samples, pixel by pixel
};

// Requires a film with such sums. As the picture is resolved with the same view.
DeepImage deepImage(const PixelFilm&, const LayerView&);

} // namespace abbe
