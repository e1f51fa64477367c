// The error of an image against references, in the measures of its certificate.
#pragma once

#include "film/error_figure.h"

#include <optional>
#include <vector>

namespace abbe {

// Mean square of an image's error, without what the noise of the references adds to its difference from them. Squared,
// so that it can be averaged; may be negative.
struct MeasuredSquare {
    double value = 0;
    double standardError = 0;  // of the value: what is left of the references' noise
    double referenceNoise = 0; // mean square of their own error, in the same measure; 0: they do not tell it

    // Root, and an interval of 95 % that knows of the references' noise alone.
    ErrorFigure root() const;
    // The same where the reference has samples of the image's own, so that their errors are not independent. By the
    // triangle inequality.
    ErrorFigure rootOfDependent() const;
};

struct MeasuredError {
    // Of an image, row by row.
    struct Planes {
        int width = 0, height = 0;
        std::vector<float> luminance;
        std::vector<float> variance; // of the luminance, as estimated; empty: unknown. Infinite: not known there
        std::vector<float> display;  // three values of a pixel, 0 to 1 can be shown; empty: unknown
    };
    // `a` and `b` are references of different seeds: what they differ by is noise and drops out. Requires equal sizes.
    static MeasuredError of(const Planes& image, const Planes& a, const Planes& b);
    // Of one reference, whose noise drops out by its own variances; without them it counts as exact, as it does for the
    // display.
    static MeasuredError of(const Planes& image, const Planes& reference);

    MeasuredSquare relative;
    std::optional<MeasuredSquare> display;
};

// A square that knew nothing of the noise of a reference, which states its own error as a figure over so many pixels
// (its certificate). The reference must have other samples than the image.
MeasuredSquare withoutNoise(const MeasuredSquare&, const ErrorFigure& reference);

} // namespace abbe
