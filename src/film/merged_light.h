// How much of a picture is merged light, and how wrong that still is.
#pragma once

#include "film/pixel_film.h"

#include <cstdint>
#include <optional>

namespace abbe {

// Merged light is gathered over disks, and blurred by them: the only bias of a picture. It is told by gathering over
// half of the area, too. Where light varies smoothly the bias is in proportion to the area [Knaus2011, sec. 4], at
// borders of what is lit or gathers to the radius; the second, which comes to more, is taken:
//     bias ≈ (wide − narrow) / (1 − 1/√2).
struct MergedLight {
    // Of the film as it is; nothing without merged light. No thread may be adding.
    static std::optional<MergedLight> of(const PixelFilm&);

    double share = 0; // of the picture's luminance
    double bias = 0;  // of the whole luminance, signed, over it
    // What the bias of tiles of 8×8 pixels is at most: the root of the mean square over the tile's luminance, which is
    // taken for at least a tenth of the picture's, and two standard errors of the mean more. The noise of two halves of
    // the replicates drops out; with a single replicate it is in it.
    double biasOfTiles = 0;
    std::uint64_t rounds = 0;
};

} // namespace abbe
