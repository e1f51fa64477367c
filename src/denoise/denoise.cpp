#include "denoise/denoise.h"

#include "base/check.h"
#include "denoise/methods.h"
#include "denoise/oidn_library.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr int kErrorRadius = 12;

// What squared errors are relative to, as relMSE has it: 0.01 where the mean of the picture is 0.25.
class Reference {
  public:
    explicit Reference(const HalfBuffers& picture) {
        double sum = 0;
        for (const std::vector<Plane>& half : picture.halves)
            for (const Plane& p : half)
                for (int y = 0; y < p.height(); ++y)
                    for (int x = 0; x < p.width(); ++x) sum += std::abs(p.row(y)[x]);
        const Plane& plane = picture.halves[0][0];
        const double mean = sum / (6. * plane.width() * plane.height());
        floor_ = mean > 0 ? static_cast<float>(0.16 * mean * mean) : 1;
    }
    float operator()(float value) const { return value * value + floor_; }

  private:
    float floor_;
};

// Mean over pixels and channels.
struct RelativeError {
    double sum = 0;
    std::uint64_t count = 0;

    void add(double squared, double reference) {
        sum += squared / reference;
        ++count;
    }
    double mean() const { return sum / static_cast<double>(count); }
};

// The errors of one picture, from the halves before and after.
class ErrorEstimate {
  public:
    ErrorEstimate(const HalfBuffers& noisy, const DenoisedHalves& denoised)
        : noisy_(noisy), denoised_(denoised), reference_(noisy), squared_(squaredError(noisy, denoised)) {}

    double relMseBefore() const;
    // At least the part that is noise: what is estimated beyond it is a difference of large numbers.
    double relMse() const;
    // Of each pixel, such that its relMSE is the estimated one.
    Plane standardError() const;

  private:
    int width() const { return squared_[0].width(); }
    int height() const { return squared_[0].height(); }
    float value(std::size_t c, int x, int y) const {
        return (denoised_[0][c].row(y)[x] + denoised_[1][c].row(y)[x]) / 2;
    }
    template <typename F> double relativeMean(const F& squared) const {
        RelativeError error;
        for (std::size_t c = 0; c < 3; ++c)
            for (int y = 0; y < height(); ++y)
                for (int x = 0; x < width(); ++x) error.add(squared(c, x, y), reference_(value(c, x, y)));
        return error.mean();
    }

    const HalfBuffers& noisy_;
    const DenoisedHalves& denoised_;
    Reference reference_;
    ColourPlanes squared_;
};

double ErrorEstimate::relMseBefore() const {
    return relativeMean([&](std::size_t c, int x, int y) {
        const float difference = noisy_.halves[0][c].row(y)[x] - noisy_.halves[1][c].row(y)[x];
        return difference * difference / 4;
    });
}

double ErrorEstimate::relMse() const {
    const double all = relativeMean([&](std::size_t c, int x, int y) { return squared_[c].row(y)[x]; });
    const double noise = relativeMean([&](std::size_t c, int x, int y) {
        const float difference = denoised_[0][c].row(y)[x] - denoised_[1][c].row(y)[x];
        return difference * difference / 4;
    });
    return std::max(all, noise);
}

// Single estimates are as noisy as the picture. Relative to the brightness they are averaged over neighbours; what is
// noise in the result bounds the error from below.
Plane ErrorEstimate::standardError() const {
    const Plane noise = remainingNoise(denoised_);
    Plane brightness(width(), height()), relative(width(), height()), relativeNoise(width(), height());
    for (int y = 0; y < height(); ++y)
        for (int x = 0; x < width(); ++x) {
            float error = 0, mean = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                error += squared_[c].row(y)[x] / 3;
                mean += std::abs(value(c, x, y)) / 3;
            }
            brightness.row(y)[x] = reference_(mean);
            relative.row(y)[x] = error / reference_(mean);
            relativeNoise.row(y)[x] = noise.row(y)[x] / reference_(mean);
        }
    relative.extend();
    relativeNoise.extend();
    Plane result = boxFilter(relative, kErrorRadius);
    const Plane bound = boxFilter(relativeNoise, 2);
    for (int y = 0; y < height(); ++y)
        for (int x = 0; x < width(); ++x)
            result.row(y)[x] = std::max(result.row(y)[x], bound.row(y)[x]) * brightness.row(y)[x];
    // The larger of two noisy numbers is too large on average.
    const double sum = relativeMean([&](std::size_t, int x, int y) { return result.row(y)[x]; });
    const double factor = sum > 0 ? relMse() / sum : 0;
    for (int y = 0; y < height(); ++y)
        for (int x = 0; x < width(); ++x) result.row(y)[x] = static_cast<float>(std::sqrt(factor * result.row(y)[x]));
    return result;
}

void checkInput(const DenoiseInput& input) {
    ABBE_CHECK(input.width >= 1 && input.height >= 1);
    for (const DenoiseChannel& c : input.colour) ABBE_CHECK(!c.mean.empty() && !c.half.empty());
}

} // namespace

std::string_view name(DenoiseMethod method) {
    constexpr std::array<std::string_view, 3> kNames{"nfor", "preview", "oidn"};
    return kNames[static_cast<std::size_t>(method)];
}

std::string version(DenoiseMethod method) {
    if (method == DenoiseMethod::oidn) return "1 (Open Image Denoise " + OidnLibrary::get().version() + ", cpu)";
    return method == DenoiseMethod::nfor ? "3" : "2";
}

namespace {

// Before its colours are scaled back.
struct Denoised {
    HalfBuffers noisy;
    Mixture mixture;
    float scale = 1;
    std::uint64_t repaired = 0, outside = 0;
};

Denoised denoiseByOwn(const DenoiseInput& input, DenoiseMethod method) {
    PreparedInput prepared = prepare(input, method == DenoiseMethod::nfor);
    Mixture mixture;
    if (method == DenoiseMethod::nfor)
        mixture = denoiseByRegression(prepared);
    else
        mixture.picture = mixture.validated = denoiseByWavelets(prepared);
    return {std::move(prepared.colour), std::move(mixture), prepared.scale, prepared.repaired};
}

Denoised denoiseByLibrary(const DenoiseInput& input, DenoiseEffort effort) {
    const OidnLibrary& library = OidnLibrary::get(); // before any work
    NoisyInput noisy = noisyInput(input);
    OidnResult result = denoiseByOidn(library, noisy, input.toRec709, effort);
    return {std::move(noisy.colour), std::move(result.mixture), noisy.scale, noisy.repaired, result.outside};
}

} // namespace

DenoiseResult denoise(const DenoiseInput& input, DenoiseMethod method, DenoiseEffort effort) {
    checkInput(input);
    const Denoised denoised =
        method == DenoiseMethod::oidn ? denoiseByLibrary(input, effort) : denoiseByOwn(input, method);
    DenoiseResult result;
    result.repaired = denoised.repaired;
    result.outside = denoised.outside;
    for (std::size_t c = 0; c < 3; ++c) {
        result.colour[c] = denoised.mixture.picture[0][c].pixels();
        const std::vector<float> other = denoised.mixture.picture[1][c].pixels();
        for (std::size_t i = 0; i < other.size(); ++i)
            result.colour[c][i] = (result.colour[c][i] + other[i]) / (2 * denoised.scale);
    }
    if (effort == DenoiseEffort::look) return result;
    const ErrorEstimate estimate(denoised.noisy, denoised.mixture.validated);
    result.relMseBefore = estimate.relMseBefore();
    result.relMseAfter = estimate.relMse();
    result.error = estimate.standardError().pixels();
    for (float& e : result.error) e /= denoised.scale;
    return result;
}

} // namespace abbe
