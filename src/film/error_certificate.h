// What an image says about its own error.
#pragma once

#include "film/error_figure.h"
#include "film/pixel_film.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

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

// Made of the means of the film's replicates and of the number of samples behind each, and of nothing else: whatever is
// added to the replicates is covered. The same for equal films, in every bit, for any number of threads.
struct ErrorCertificate {
    // How the film becomes the picture that is certified.
    struct Picture {
        Matrix3 balance;                               // on XYZ
        Matrix3 toRgb;                                 // from balanced XYZ
        double scale = 1;                              // of all values
        std::function<void(std::span<float>)> display; // linear RGB to code values from 0 to 1, in place; null: none
    };
    // Requires that no thread is adding.
    static ErrorCertificate of(const PixelFilm&, const Picture&);

    std::string reason; // why there is no certificate; empty: there is one
    int replicates = 0;
    std::int64_t pixels = 0;            // of the film
    std::uint64_t fewest = 0, most = 0; // samples in a pixel
    double samples = 0;                 // their mean

    ErrorFigure relative; // of Y: RelativeError
    // √ mean (x − t)² of the three display values from 0 to 255, before they are rounded.
    std::optional<ErrorFigure> display;
    // What the figures above know nothing of; none: the picture is unbiased.
    std::optional<MergedLight> merged;
    std::string view, displayReason; // the display's, and why it is missing; ErrorCertificate::of leaves them empty
};

} // namespace abbe
