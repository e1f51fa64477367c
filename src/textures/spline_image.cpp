#include "textures/spline_image.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// The four weights of a uniform cubic B-spline at t in [0, 1), and their derivatives.
struct Spline {
    float weight[4], slope[4];
    explicit Spline(float t) {
        const float s = 1 - t;
        weight[0] = s * s * s / 6;
        weight[1] = (4 - 3 * t * t * (2 - t)) / 6;
        weight[2] = (4 - 3 * s * s * (2 - s)) / 6;
        weight[3] = t * t * t / 6;
        slope[0] = -s * s / 2;
        slope[1] = t * (1.5f * t - 2);
        slope[2] = s * (2 - 1.5f * s);
        slope[3] = t * t / 2;
    }
};

// The texel that stands for index i, or -1 for black.
std::int64_t wrapped(std::int64_t i, std::int64_t n, Wrap wrap) {
    if (i >= 0 && i < n) return i;
    switch (wrap) {
    case Wrap::clamp:
        return i < 0 ? 0 : n - 1;
    case Wrap::black:
        return -1;
    case Wrap::periodic: {
        const std::int64_t k = i % n;
        return k < 0 ? k + n : k;
    }
    case Wrap::mirror: {
        std::int64_t k = i % (2 * n);
        if (k < 0) k += 2 * n;
        return k < n ? k : 2 * n - 1 - k;
    }
    }
    return -1;
}

// Four texels in a row around coordinate x (in texels) with their weights.
struct Taps {
    Spline spline;
    std::int64_t texel[4];
    Taps(double x, int n, Wrap wrap) : Taps(std::floor(x), x, n, wrap) {}

  private:
    Taps(double whole, double x, int n, Wrap wrap) : spline(static_cast<float>(x - whole)) {
        for (int k = 0; k < 4; ++k) texel[k] = wrapped(static_cast<std::int64_t>(whole) - 1 + k, n, wrap);
    }
};

constexpr double kFarthestUv = 1e12; // texture coordinates beyond have no fraction of a texel left

double tame(float x) { return std::abs(x) < kFarthestUv ? static_cast<double>(x) : 0; }

} // namespace

SplineImage::SplineImage(ImagePixels image, Wrap wrap) : wrap_(wrap) { tiles_.emplace(1001, std::move(image)); }

SplineImage::SplineImage(std::map<int, ImagePixels> tiles)
    : tiles_(std::move(tiles)), tiled_(true), wrap_(Wrap::clamp) {}

// The tile of a point, and its coordinates in it. On the border between two tiles the face decides.
const ImagePixels* SplineImage::tileOf(const TexturePoint& point, double& u, double& v) const noexcept {
    u = tame(point.uv.x);
    v = tame(point.uv.y);
    if (!tiled_) return &tiles_.begin()->second;
    const auto column = [](double x, float home) {
        const double nearest = std::round(x);
        return std::abs(x - nearest) < 1e-4 ? std::clamp(std::floor(tame(home)), nearest - 1, nearest) : std::floor(x);
    };
    const double i = column(u, point.home.x), j = column(v, point.home.y);
    if (!(i >= 0 && i < 10 && j >= 0 && j < 100)) return nullptr;
    const auto found = tiles_.find(1001 + static_cast<int>(i) + 10 * static_cast<int>(j));
    if (found == tiles_.end()) return nullptr;
    u -= i;
    v -= j;
    return &found->second;
}

TextureJet SplineImage::jet(const TexturePoint& point, int channels) const noexcept {
    TextureJet result;
    double u = 0, v = 0;
    const ImagePixels* const tile = tileOf(point, u, v);
    if (!tile) return result;
    const Taps x(u * tile->width - 0.5, tile->width, wrap_), y((1 - v) * tile->height - 0.5, tile->height, wrap_);
    float value[3] = {}, byX[3] = {}, byY[3] = {};
    for (int j = 0; j < 4; ++j) {
        if (y.texel[j] < 0) continue;
        const float* const row = tile->values.data() + y.texel[j] * tile->width * tile->channels;
        for (int c = 0; c < channels; ++c) {
            float sum = 0, slope = 0;
            for (int i = 0; i < 4; ++i) {
                if (x.texel[i] < 0) continue;
                const float texel = row[x.texel[i] * tile->channels + c];
                sum += x.spline.weight[i] * texel;
                slope += x.spline.slope[i] * texel;
            }
            value[c] += y.spline.weight[j] * sum;
            byX[c] += y.spline.weight[j] * slope;
            byY[c] += y.spline.slope[j] * sum;
        }
    }
    result.value = {value[0], value[1], value[2]};
    result.byUv[0] = Vec3{byX[0], byX[1], byX[2]} * static_cast<float>(tile->width);
    result.byUv[1] = Vec3{byY[0], byY[1], byY[2]} * -static_cast<float>(tile->height);
    return result;
}

} // namespace abbe
