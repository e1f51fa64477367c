// The images of `abbe compare`, with variances where the file has them, and what it says about an image and a
// reference.
#pragma once

#include "app/json.h"
#include "io/flip.h"
#include "io/image.h"
#include "io/image_compare.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

struct CompareImage {
    std::string path;
    RgbImage picture;
    std::vector<float> variance; // of the luminance of each pixel; empty if unknown
    int replicates = 2;          // behind each variance
    double rounding = 0;         // relative, of stored values

    // OpenEXR or Radiance. Throws IoError.
    static CompareImage read(const std::string& path);
    // The mean of images of one size; their variances shrink accordingly.
    static CompareImage mean(std::span<const CompareImage>);

    std::vector<float> luminance() const; // as the chromaticities define it
};

// Nothing if either image has no variances. Requires equal sizes.
std::optional<TileTest> tileTest(const CompareImage& image, const CompareImage& reference);

struct CompareFigures {
    // `references` are one or two images of the same thing; `reference` is their mean. Two from different seeds make
    // relMSE free of their noise. Requires equal sizes.
    static CompareFigures measure(const CompareImage&, std::span<const CompareImage> references,
                                  const CompareImage& reference, double pixelsPerDegree);

    Json json() const;

    ImageDifference difference; // its relMse is the one without the noise of two references
    bool unbiased = false;
    double pixelsPerDegree = 0;
    std::optional<HdrFlip> flip;          // nothing if some pixel is not finite
    std::optional<ColorDifference> color; // likewise
    std::optional<TileTest> tiles;        // nothing without variances
};

// A number that can be printed, bounded and compared between images.
struct CompareFigure {
    const char* name; // on the command line
    const char* label;
    const char* format; // of fmt, for a double
    bool atLeast;       // a larger one is better, so that a bound is a lower one
    // NaN if it cannot be told.
    double (*value)(const CompareFigures&);

    std::string text(const CompareFigures&) const; // "–" if it cannot be told
    // NaN is never within.
    bool within(const CompareFigures&, double bound) const;
};
std::span<const CompareFigure> compareFigures();
const CompareFigure* findCompareFigure(std::string_view name);

} // namespace abbe
