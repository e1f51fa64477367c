#include "denoise/nfor.h"

#include "base/parallel.h"
#include "denoise/regression.h"

#include <algorithm>
#include <utility>

namespace abbe {

namespace {

constexpr int kComparedRadius = 7, kBlendedRadius = 4;

// How much the first candidate is to be preferred, 0 to 1: where its estimated error, relative to the brightness and
// averaged around the pixel, is smaller; blurred, so that the choice leaves no edges.
Plane choose(const HalfBuffers& noisy, const DenoisedHalves& first, const DenoisedHalves& second) {
    const int width = noisy.variances[0].width(), height = noisy.variances[0].height();
    const ColourPlanes a = squaredError(noisy, first), b = squaredError(noisy, second);
    Plane advantage(width, height), choice(width, height);
    const auto rows = static_cast<std::size_t>(height);
    parallelFor(rows, [&](std::size_t i) {
        const int y = static_cast<int>(i);
        for (std::size_t c = 0; c < 3; ++c)
            for (int x = 0; x < width; ++x) {
                const float value = (first[0][c].row(y)[x] + first[1][c].row(y)[x]) / 2;
                advantage.row(y)[x] += (b[c].row(y)[x] - a[c].row(y)[x]) / (value * value + 0.01f);
            }
    });
    advantage.extend();
    const Plane smooth = boxFilter(advantage, kComparedRadius);
    parallelFor(rows, [&](std::size_t i) {
        const int y = static_cast<int>(i);
        for (int x = 0; x < width; ++x) choice.row(y)[x] = smooth.row(y)[x] >= 0 ? 1.f : 0.f;
    });
    choice.extend();
    return boxFilter(choice, kBlendedRadius);
}

// to += weight · (from − to)
void blend(const Plane& weight, const Plane& from, Plane& to) {
    parallelFor(static_cast<std::size_t>(to.height()), [&](std::size_t i) {
        const int y = static_cast<int>(i);
        for (int x = 0; x < to.width(); ++x) to.row(y)[x] += weight.row(y)[x] * (from.row(y)[x] - to.row(y)[x]);
    });
    to.extend();
}

} // namespace

DenoisedHalves denoiseByRegression(const PreparedInput& input) {
    DenoisedHalves smooth, sharp;
    for (std::size_t half = 0; half < 2; ++half) {
        // The weights come from the same half, so that the other one can tell how large the error is.
        auto results = regress(input.colour.halves[half], input.features, input.guide.guide(half, kColourEpsilon));
        smooth[half] = std::move(results[0]);
        sharp[half] = std::move(results[1]);
    }
    const Plane choice = choose(input.colour, smooth, sharp);
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t c = 0; c < 3; ++c) blend(choice, smooth[half][c], sharp[half][c]);
    return sharp;
}

} // namespace abbe
