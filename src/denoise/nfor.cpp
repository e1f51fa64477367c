#include "denoise/nfor.h"

#include "denoise/regression.h"
#include "denoise/wavelets.h"

#include <utility>

namespace abbe {

namespace {

// Of the noise that a weight may overlook, what is left where the guide is denoised.
constexpr float kGuideVariance = 0.06f;
constexpr float kGuideEpsilon = 1e-4f; // squared difference of a denoised guide that counts as none

// The narrow weights of a pass are the wide ones to this power of two: k = 0.35 and k = 0.7 instead of 2.
constexpr int kFirstNarrowing = 5, kSecondNarrowing = 3;

using Candidates = std::vector<DenoisedHalves>;

// Adds the results of both bandwidths. guides[half]: where the weights of that half come from, always itself, so that
// the other half can tell how large the error is.
void addPass(const PreparedInput& input, const std::array<Guide, 2>& guides, int narrowing, Candidates& candidates) {
    DenoisedHalves wide, narrow;
    for (std::size_t half = 0; half < 2; ++half) {
        auto results = regress(input.colour.halves[half], input.modulation, input.features, guides[half], narrowing);
        wide[half] = std::move(results[0]);
        narrow[half] = std::move(results[1]);
    }
    candidates.push_back(std::move(wide));
    candidates.push_back(std::move(narrow));
}

std::vector<Plane> scaled(std::vector<Plane> planes, float factor) {
    for (Plane& plane : planes) {
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x) plane.row(y)[x] *= factor;
        plane.extend();
    }
    return planes;
}

void addSecondPass(const PreparedInput& input, const DenoisedHalves& first, Candidates& candidates) {
    const std::vector<Plane> variances = scaled(input.guide.variances, kGuideVariance);
    std::array<std::vector<Plane>, 2> values;
    std::array<Guide, 2> guides;
    for (std::size_t half = 0; half < 2; ++half) {
        ColourPlanes shading = first[half];
        divide(shading, input.divisor);
        values[half] = compressed({shading[0], shading[1], shading[2]});
        guides[half] = guideOf(values[half], variances, kGuideEpsilon);
    }
    addPass(input, guides, kSecondNarrowing, candidates);
}

DenoisedHalves untouched(const HalfBuffers& colour) {
    DenoisedHalves result;
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t c = 0; c < 3; ++c) result[half][c] = colour.halves[half][c];
    return result;
}

} // namespace

// What goes with no albedo, mirror images and highlights, would get its texture by being divided by it: there the
// candidates that are divided by nothing win.
Mixture denoiseByRegression(const PreparedInput& input) {
    const PreparedInput plain = undivided(input);
    Candidates candidates;
    addPass(input, {input.guide.guide(0, kColourEpsilon), input.guide.guide(1, kColourEpsilon)}, kFirstNarrowing,
            candidates);
    candidates.push_back(denoiseByWavelets(input));
    candidates.push_back(denoiseByWavelets(plain));
    const DenoisedHalves first = mix(input.colour, candidates).picture;
    addSecondPass(input, first, candidates);
    addSecondPass(plain, first, candidates);
    candidates.push_back(untouched(input.colour));
    return mix(input.colour, candidates);
}

} // namespace abbe
