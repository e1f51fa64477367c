// Whether the intervals of certificates hold the errors that images have.
#pragma once

#include "film/error_certificate.h"
#include "film/measured_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace abbe::test {

// `values` are balanced and scaled.
inline MeasuredError::Planes measuredPlanes(const ErrorCertificate::Picture& picture, PixelBounds bounds,
                                            const std::vector<Xyz>& values) {
    MeasuredError::Planes planes{bounds.width(), bounds.height(), {}, {}, {}};
    for (const Xyz& xyz : values) {
        planes.luminance.push_back(static_cast<float>(xyz.y));
        const auto rgb = picture.toRgb.apply<Xyz>(xyz);
        for (const double v : {rgb.x, rgb.y, rgb.z}) planes.display.push_back(static_cast<float>(v));
    }
    picture.display(planes.display);
    return planes;
}

// Of the replicates [first, last).
inline MeasuredError::Planes measuredPlanes(const ErrorCertificate::Picture& picture, const PixelFilm& film, int first,
                                            int last) {
    std::vector<Xyz> values;
    const PixelBounds b = film.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x)
            values.push_back(picture.balance.apply<Xyz>(film.mean(x, y, first, last) * picture.scale));
    return measuredPlanes(picture, b, values);
}

// Of one figure over many seeds.
struct Coverage {
    int trials = 0, held = 0, below = 0, above = 0; // the error is below or above the interval
    double width = 0, error = 0, ratio = 0, ratioSquares = 0;

    void add(const ErrorFigure& stated, double squared) {
        const double measured = std::sqrt(std::max(squared, 0.0));
        ++trials;
        held += stated.holds(measured);
        below += measured < stated.low;
        above += measured > stated.high;
        width += (stated.high - stated.low) / stated.value;
        error += measured;
        const double log = std::log(measured / stated.value);
        ratio += log;
        ratioSquares += log * log;
    }
    double share() const { return static_cast<double>(held) / trials; }
    double meanWidth() const { return width / trials; } // high − low, relative to the figure
    double meanError() const { return error / trials; }
    double bias() const { return ratio / trials; } // mean of ln(measured/stated)
    // Width of the narrowest interval that would do on average, if the deviations were normal.
    double idealWidth() const { return 2 * 1.96 * std::sqrt(ratioSquares / trials); }
};

struct Coverages {
    Coverage relative, display;

    void add(const ErrorCertificate& certificate, const MeasuredError& measured) {
        relative.add(certificate.relative, measured.relative.value);
        display.add(*certificate.display, measured.display->value);
    }
};

} // namespace abbe::test
