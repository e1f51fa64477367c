#include "denoise/methods.h"

#include "base/check.h"
#include "base/parallel.h"
#include "denoise/plane.h"
#include "denoise/regression.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
std::vector<Plane> comparedErrors(const HalfBuffers& noisy, const std::vector<DenoisedHalves>& candidates,
                                  float influence) {
    std::vector<Plane> errors;
    for (const DenoisedHalves& c : candidates) errors.push_back(relativeError(noisy, c, candidates[0]));
    forEachRow(errors[0], [&](int y) {
        for (int x = 0; x < errors[0].width(); ++x) {
            float mean = 0;
            for (const Plane& e : errors) mean += e.row(y)[x] / static_cast<float>(errors.size());
            for (Plane& e : errors) e.row(y)[x] = std::clamp(e.row(y)[x] - mean, -influence, influence);
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

// The weights of the candidates from their errors at some pixels; 1 together. `doubt`: how much less than the others
// the last one counts where they cannot be told apart, a logarithm.
std::vector<Plane> weightsFrom(const std::vector<Plane>& errors, Pixels pixels, float doubt) {
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
                const float less = k + 1 == errors.size() ? doubt : 0;
                sum += weights[k].row(y)[x] = std::exp(-excess / (std::sqrt(spread) + kLeastSpread) - less);
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

namespace {

struct MixRule {
    float influence = kInfluence;
    float doubt = 0;
};

Mixture mix(const HalfBuffers& noisy, const std::vector<DenoisedHalves>& candidates,
            const std::vector<DenoisedHalves>& shown, const MixRule& rule) {
    ABBE_CHECK(!candidates.empty());
    const std::vector<Plane> errors = comparedErrors(noisy, candidates, rule.influence);
    const auto weights = [&](Pixels pixels) { return weightsFrom(errors, pixels, rule.doubt); };
    const Plane empty(errors[0].width(), errors[0].height());
    Mixture mixture;
    for (DenoisedHalves* halves : {&mixture.picture, &mixture.validated})
        for (ColourPlanes& half : *halves) half.fill(empty);
    blend(shown, weights(Pixels::all), Pixels::all, mixture.picture);
    blend(candidates, weights(Pixels::white), Pixels::black, mixture.validated);
    blend(candidates, weights(Pixels::black), Pixels::white, mixture.validated);
    return mixture;
}

DenoisedHalves untouched(const HalfBuffers& colour) {
    DenoisedHalves result;
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t c = 0; c < 3; ++c) result[half][c] = colour.halves[half][c];
    return result;
}

} // namespace

Mixture mix(const HalfBuffers& noisy, const std::vector<DenoisedHalves>& candidates) {
    return mix(noisy, candidates, candidates, {});
}

// Rare bright pixels have all the noise in some places, and what is left there of a pixel's error if they are bounded
// speaks for the picture as it is. That is where a network is of most use.
Mixture mixWithUntouched(const HalfBuffers& noisy, const DenoisedHalves& candidate, const DenoisedHalves& whole) {
    constexpr MixRule kRule{20, 3};
    const DenoisedHalves same = untouched(noisy);
    return mix(noisy, {candidate, same}, {whole, same}, kRule);
}

namespace {

constexpr int kLevels = 5;
static_assert(2 << (kLevels - 1) <= Plane::kBorder - kLanes); // the farthest pixel that is looked at
constexpr float kNoiseWidths = 3; // standard deviations of noise that a difference of colour may have
constexpr int kVarianceRadius = 3;
constexpr float kFeatureWidth = 0.05f; // difference of features that halves a weight, roughly

// One half between two levels: its colours, and of the compressed ones the mean variance of a channel.
struct Level {
    std::vector<Plane> colours;
    Plane variance;
};

// Smoother than that of the guide: a pixel is compared with few others, and not with their surroundings.
Plane meanVariance(const HalfBuffers& guide) {
    Plane variance(guide.variances[0].width(), guide.variances[0].height());
    for (int y = 0; y < variance.height(); ++y)
        for (int x = 0; x < variance.width(); ++x)
            for (const Plane& p : guide.variances) variance.row(y)[x] += p.row(y)[x] / 3;
    variance.extend();
    return boxFilter(variance, kVarianceRadius);
}

// The squared distance of pixels in units of what separates surfaces and of the noise of `guide`.
struct Distance {
    const std::vector<Plane>& features;
    const std::vector<Plane>& guide; // compressed colours
    const Plane& variance;

    Lanes operator()(int x, int y, int u, int v) const {
        const auto sumOfSquares = [&](const std::vector<Plane>& planes) {
            Lanes sum{};
            for (const Plane& plane : planes) {
                const Lanes d = load(plane.row(y) + x) - load(plane.row(v) + u);
                sum += d * d;
            }
            return sum;
        };
        const Lanes noise = 3.f * (load(variance.row(y) + x) + load(variance.row(v) + u)) + kColourEpsilon;
        return sumOfSquares(features) * (1 / (kFeatureWidth * kFeatureWidth)) +
               sumOfSquares(guide) / (kNoiseWidths * kNoiseWidths * noise);
    }
};

// Eight pixels of the next level, each from 5 × 5 that are `step` apart, with the weights of a cubic B-spline. Beyond
// the edges of the picture its border counts.
void filterPixels(const Level& from, const Distance& distance, int x, int y, int step, Level& to) {
    constexpr std::array<float, 5> kSpline{1 / 16.f, 1 / 4.f, 3 / 8.f, 1 / 4.f, 1 / 16.f};
    Lanes sum[3] = {}, variance{}, total{};
    for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
            const int u = x + i * step, v = y + j * step;
            const float spline = kSpline[static_cast<std::size_t>(i + 2)] * kSpline[static_cast<std::size_t>(j + 2)];
            const Lanes w = spline * decay(distance(x, y, u, v));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w * load(from.colours[c].row(v) + u);
            variance += w * w * load(from.variance.row(v) + u);
            total += w;
        }
    for (std::size_t c = 0; c < 3; ++c) store(to.colours[c].row(y) + x, sum[c] / total);
    store(to.variance.row(y) + x, variance / (total * total));
}

Level nextLevel(const Level& from, const std::vector<Plane>& features, int step) {
    const int width = from.variance.width(), height = from.variance.height();
    Level to{{3, Plane(width, height)}, Plane(width, height)};
    const std::vector<Plane> guide = compressed(from.colours);
    const Distance distance{features, guide, from.variance};
    parallelFor(static_cast<std::size_t>(height), [&](std::size_t y) {
        for (int x = 0; x < width; x += kLanes) filterPixels(from, distance, x, static_cast<int>(y), step, to);
    });
    for (Plane& plane : to.colours) plane.extend();
    to.variance.extend();
    return to;
}

} // namespace

DenoisedHalves denoiseByWavelets(const PreparedInput& input) {
    const Plane variance = meanVariance(input.guide);
    std::array<Level, 2> halves{Level{input.shading[0], variance}, Level{input.shading[1], variance}};
    for (int level = 0; level < kLevels; ++level) {
        for (Level& half : halves) half = nextLevel(half, input.features, 1 << level);
    }
    DenoisedHalves result;
    for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t c = 0; c < 3; ++c) result[half][c] = std::move(halves[half].colours[c]);
        multiply(result[half], input.divisor);
    }
    return result;
}

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
