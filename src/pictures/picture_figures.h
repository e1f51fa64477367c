// How bright a picture is: what `exposure auto` goes by, and what is proposed when a picture shows nothing; key figures
// of a finished picture: how bright it is, how much of it a display can show, and how an adaptive render spread its
// samples.
#pragma once

#include "film/pixel_film.h"
#include "pictures/display_view.h"
#include "render/integrator.h"
#include "render/scene.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace abbe {

// Linear value that views show as middle grey: that of a card that reflects 18 %.
inline constexpr double kMiddleGrey = 0.18;

// The stops, in tenths, that show the geometric mean of pixel values [Reinhard2002, sec. 3.1] in middle grey. What is
// darker than a thousandth of the median of those above 0 counts as night around the picture and not for the mean.
// Nothing where no value is above 0.
std::optional<double> stopsForMiddleGrey(std::span<const float> luminances);

// The same for a scene before the first sample, from 16 samples of at most 32 × 32 pixels of the whole frame. They have
// a seed of their own and come from camera paths alone, so that the result depends on the scene, its camera and the
// size of the frame, and on no number of samples or threads, seed, crop or part of the render. `sensitivity`: pixel
// value per unit of radiance. Nothing if they find no light.
std::optional<double> meterExposure(const Scene&, const Integrator&, std::uint32_t maxDepth, double sensitivity);

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
