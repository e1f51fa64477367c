#include "denoise/denoise.h"

#include "base/check.h"
#include "denoise/nfor.h"
#include "denoise/wavelets.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr int kErrorRadius = 12;

// What squared errors are relative to, as in relMSE: the mean of the picture is 0.25.
float reference(float value) { return value * value + 0.01f; }

// Single estimates are as noisy as the picture. Relative to the brightness they are averaged over neighbours; what is
// noise in the result bounds the error from below.
Plane standardError(const ColourPlanes& squared, const DenoisedHalves& denoised) {
    const int width = squared[0].width(), height = squared[0].height();
    const Plane noise = remainingNoise(denoised);
    Plane brightness(width, height), relative(width, height), relativeNoise(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float error = 0, value = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                error += squared[c].row(y)[x] / 3;
                value += std::abs(denoised[0][c].row(y)[x] + denoised[1][c].row(y)[x]) / 6;
            }
            brightness.row(y)[x] = reference(value);
            relative.row(y)[x] = error / reference(value);
            relativeNoise.row(y)[x] = noise.row(y)[x] / reference(value);
        }
    relative.extend();
    relativeNoise.extend();
    Plane result = boxFilter(relative, kErrorRadius);
    const Plane bound = boxFilter(relativeNoise, 2);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float error = std::max(result.row(y)[x], bound.row(y)[x]);
            result.row(y)[x] = std::sqrt(error * brightness.row(y)[x]);
        }
    return result;
}

// relMSE with the denoised picture in the place of the reference, and the squared errors as given.
struct RelativeError {
    double sum = 0;
    std::uint64_t count = 0;

    void add(double squared, double value) {
        sum += squared / (value * value + 0.01);
        ++count;
    }
    double mean() const { return sum / static_cast<double>(count); }
};

void estimateErrors(const HalfBuffers& noisy, const DenoisedHalves& denoised, float scale, DenoiseResult& result) {
    const ColourPlanes squared = squaredError(noisy, denoised);
    RelativeError before, after;
    for (std::size_t c = 0; c < 3; ++c)
        for (int y = 0; y < squared[c].height(); ++y)
            for (int x = 0; x < squared[c].width(); ++x) {
                const double value = (denoised[0][c].row(y)[x] + denoised[1][c].row(y)[x]) / 2;
                const double difference = noisy.halves[0][c].row(y)[x] - noisy.halves[1][c].row(y)[x];
                before.add(difference * difference / 4, value);
                after.add(squared[c].row(y)[x], value);
            }
    result.relMseBefore = before.mean();
    result.relMseAfter = std::max(after.mean(), 0.);
    result.error = standardError(squared, denoised).pixels();
    for (float& e : result.error) e /= scale;
}

void checkInput(const DenoiseInput& input) {
    ABBE_CHECK(input.width >= 1 && input.height >= 1);
    for (const DenoiseChannel& c : input.colour) ABBE_CHECK(!c.mean.empty() && !c.half.empty());
}

} // namespace

std::string_view name(DenoiseMethod method) { return method == DenoiseMethod::nfor ? "nfor" : "preview"; }
std::string_view version(DenoiseMethod) { return "1"; }

DenoiseResult denoise(const DenoiseInput& input, DenoiseMethod method) {
    checkInput(input);
    const PreparedInput prepared = prepare(input, method == DenoiseMethod::nfor);
    const DenoisedHalves halves =
        method == DenoiseMethod::nfor ? denoiseByRegression(prepared) : denoiseByWavelets(prepared);
    DenoiseResult result;
    result.repaired = prepared.repaired;
    for (std::size_t c = 0; c < 3; ++c) {
        result.colour[c] = halves[0][c].pixels();
        const std::vector<float> other = halves[1][c].pixels();
        for (std::size_t i = 0; i < other.size(); ++i)
            result.colour[c][i] = (result.colour[c][i] + other[i]) / (2 * prepared.scale);
    }
    estimateErrors(prepared.colour, halves, prepared.scale, result);
    return result;
}

} // namespace abbe
