#include "denoise/mixture.h"

#include "base/check.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr int kComparedRadius = 5, kBlendedRadius = 3;
constexpr float kSoftness = 0.7f;      // standard deviations of a difference that take a weight to 1/e
constexpr float kBrightness = 0.01f;   // errors are relative to v² + this, where the typical v is kTypical
constexpr float kInfluence = 0.1f;     // a pixel where a candidate is off by far shall not decide for its neighbours
constexpr float kLeastSpread = 1e-12f; // below any difference that can be seen

template <typename Body> void forEachRow(const Plane& like, const Body& body) {
    parallelFor(static_cast<std::size_t>(like.height()), [&](std::size_t y) { body(static_cast<int>(y)); });
}

Plane relativeError(const HalfBuffers& noisy, const DenoisedHalves& candidate, const DenoisedHalves& brightness) {
    const ColourPlanes error = squaredError(noisy, candidate);
    Plane sum(error[0].width(), error[0].height());
    forEachRow(sum, [&](int y) {
        for (std::size_t c = 0; c < 3; ++c)
            for (int x = 0; x < sum.width(); ++x) {
                const float value = (brightness[0][c].row(y)[x] + brightness[1][c].row(y)[x]) / 2;
                sum.row(y)[x] += error[c].row(y)[x] / (value * value + kBrightness);
            }
    });
    return sum;
}

// Relative errors of all candidates, less their mean at each pixel: the noise of the picture that they share. Bounded.
std::vector<Plane> comparedErrors(const HalfBuffers& noisy, const std::vector<DenoisedHalves>& candidates) {
    std::vector<Plane> errors;
    for (const DenoisedHalves& c : candidates) errors.push_back(relativeError(noisy, c, candidates[0]));
    forEachRow(errors[0], [&](int y) {
        for (int x = 0; x < errors[0].width(); ++x) {
            float mean = 0;
            for (const Plane& e : errors) mean += e.row(y)[x] / static_cast<float>(errors.size());
            for (Plane& e : errors) e.row(y)[x] = std::clamp(e.row(y)[x] - mean, -kInfluence, kInfluence);
        }
    });
    return errors;
}

enum class Pixels { all, black, white }; // of a chessboard

// The mean of values or of their squares around each pixel; of black or white ones alone half of it.
Plane localMean(const Plane& values, Pixels pixels, bool squares) {
    Plane kept(values.width(), values.height());
    forEachRow(kept, [&](int y) {
        for (int x = 0; x < kept.width(); ++x) {
            const float v = values.row(y)[x];
            if (pixels == Pixels::all || (pixels == Pixels::black) == ((x + y) % 2 == 0))
                kept.row(y)[x] = squares ? v * v : v;
        }
    });
    kept.extend();
    return boxFilter(kept, kComparedRadius);
}

// The weights of the candidates from their errors at some pixels; 1 together.
std::vector<Plane> weightsFrom(const std::vector<Plane>& errors, Pixels pixels) {
    std::vector<Plane> means, squares;
    for (const Plane& e : errors) {
        means.push_back(localMean(e, pixels, false));
        squares.push_back(localMean(e, pixels, true));
    }
    // The variance of a mean of n: of half as many pixels it is twice that, and both means are half of theirs.
    constexpr int kSide = 2 * kComparedRadius + 1;
    constexpr float kScale = kSoftness * kSoftness / (kSide * kSide);
    std::vector<Plane> weights(errors.size(), Plane(errors[0].width(), errors[0].height()));
    forEachRow(errors[0], [&](int y) {
        for (int x = 0; x < errors[0].width(); ++x) {
            std::size_t best = 0;
            for (std::size_t k = 1; k < errors.size(); ++k)
                if (means[k].row(y)[x] < means[best].row(y)[x]) best = k;
            float sum = 0;
            for (std::size_t k = 0; k < errors.size(); ++k) {
                const float spread = kScale * (squares[k].row(y)[x] + squares[best].row(y)[x]);
                const float excess = means[k].row(y)[x] - means[best].row(y)[x];
                sum += weights[k].row(y)[x] = std::exp(-excess / (std::sqrt(spread) + kLeastSpread));
            }
            for (Plane& w : weights) w.row(y)[x] /= sum;
        }
    });
    for (Plane& w : weights) {
        w.extend();
        w = boxFilter(w, kBlendedRadius);
    }
    return weights;
}

// Adds the candidates with their weights at some pixels.
void blend(const std::vector<DenoisedHalves>& candidates, const std::vector<Plane>& weights, Pixels pixels,
           DenoisedHalves& result) {
    const int every = pixels == Pixels::all ? 1 : 2;
    for (std::size_t k = 0; k < candidates.size(); ++k)
        forEachRow(weights[k], [&](int y) {
            const int first = pixels == Pixels::all ? 0 : (y + (pixels == Pixels::white ? 1 : 0)) % 2;
            for (std::size_t half = 0; half < 2; ++half)
                for (std::size_t c = 0; c < 3; ++c)
                    for (int x = first; x < weights[k].width(); x += every)
                        result[half][c].row(y)[x] += weights[k].row(y)[x] * candidates[k][half][c].row(y)[x];
        });
    for (ColourPlanes& half : result)
        for (Plane& plane : half) plane.extend();
}

} // namespace

Mixture mix(const HalfBuffers& noisy, const std::vector<DenoisedHalves>& candidates) {
    ABBE_CHECK(!candidates.empty());
    const std::vector<Plane> errors = comparedErrors(noisy, candidates);
    const Plane empty(errors[0].width(), errors[0].height());
    Mixture mixture;
    for (DenoisedHalves* halves : {&mixture.picture, &mixture.validated})
        for (ColourPlanes& half : *halves) half.fill(empty);
    blend(candidates, weightsFrom(errors, Pixels::all), Pixels::all, mixture.picture);
    blend(candidates, weightsFrom(errors, Pixels::white), Pixels::black, mixture.validated);
    blend(candidates, weightsFrom(errors, Pixels::black), Pixels::white, mixture.validated);
    return mixture;
}

} // namespace abbe
