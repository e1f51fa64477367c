// Key figures of a finished picture: how bright it is, how much of it a display can show, and how an adaptive render
// spread its samples.
#pragma once

#include "film/pixel_film.h"
#include "pictures/display_view.h"

#include <cstdint>
#include <optional>
#include <string>

namespace abbe {

// Shares of pixels.
struct DisplayShares {
    double black = 0; // no component above 1 % of the display
    double white = 0; // a component above 99 %
};

struct PictureFigures {
    double median = 0, high = 0; // luminance that half and 99 % of the pixels have at most, nits; before any exposure
    std::optional<DisplayShares> display; // nothing: there is no view
    // Set where nearly all that is not exactly 0 is black on the display, or nearly all of it white, and other stops
    // would show it: to be added to those of the camera.
    std::optional<double> missingStops;
};

// What a picture is made of. `exposure`: factor from radiance to pixel values; `viewStops`: those of the view, which
// may be null.
struct ShownPicture {
    const PixelFilm& film;
    const ResolvedImage& image;
    PixelBounds frame; // what of the image counts, if it has any of that
    double exposure = 1;
    const DisplayView* view = nullptr;
    double viewStops = 0;
};

PictureFigures figuresOf(const ShownPicture&);

// Samples of pixels, all replicates together.
struct SampleSpread {
    std::uint64_t least = 0, most = 0;
    double mean = 0;

    bool even() const { return least == most; }
    std::string text() const; // "from 16 to 512, 61.3 on average"
};

// No thread may be adding.
SampleSpread sampleSpread(const PixelFilm&);

} // namespace abbe
