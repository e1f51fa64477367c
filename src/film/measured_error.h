// The error of an image against references, in the measures of its certificate.
#pragma once

#include <optional>
#include <vector>

namespace abbe {

// Squared, so that it can be averaged.
struct MeasuredError {
    // Of an image, row by row.
    struct Planes {
        int width = 0, height = 0;
        std::vector<float> luminance;
        std::vector<float> display; // three values of a pixel, 0 to 1 can be shown; empty: unknown
    };
    // `a` and `b` are references of different seeds: what they differ by is noise and drops out, so that errors can be
    // negative. The same twice if there is one alone. Requires equal sizes.
    static MeasuredError of(const Planes& image, const Planes& a, const Planes& b);

    double relative = 0;
    std::optional<double> display;
};

} // namespace abbe
