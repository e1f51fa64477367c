// What an image says about its own error.
#pragma once

#include "film/error_figure.h"
#include "film/merged_light.h"
#include "film/pixel_film.h"

#include <functional>
#include <optional>
#include <span>
#include <string>

namespace abbe {

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

    ErrorFigure relative; // of Y: film/relative_error.h
    // √ mean (x − t)² of the three display values from 0 to 255, before they are rounded.
    std::optional<ErrorFigure> display;
    // What the figures above know nothing of; none: the picture is unbiased.
    std::optional<MergedLight> merged;
    std::string view, displayReason; // the display's, and why it is missing; ErrorCertificate::of leaves them empty
};

} // namespace abbe
