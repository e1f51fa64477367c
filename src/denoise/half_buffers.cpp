#include "denoise/half_buffers.h"

#include "base/check.h"
#include "base/parallel.h"
#include "denoise/plane.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr int kPatch = 2 * PatchWeights::kPatchRadius + 1;
constexpr int kStride = Tile::kSize + kLanes; // of distances_: holds a tile's width and two patch radii
static_assert(kStride >= Tile::kSize + kPatch - 1);

} // namespace

PatchWeights::PatchWeights(int windowRadius)
    : radius_(windowRadius), distances_(static_cast<std::size_t>(kStride * (Tile::kSize + kPatch - 1))) {
    ABBE_CHECK(windowRadius >= 0 && windowRadius <= 9);
    weights_.resize(offset(radius_, radius_, Tile::kSize));
}

void PatchWeights::compute(const Guide& guide, const Tile& tile) {
    for (int dy = -radius_; dy <= radius_; ++dy)
        for (int dx = -radius_; dx <= radius_; ++dx) {
            measure(guide, tile, dx, dy);
            average(tile, dx, dy);
            clip(guide, tile, dx, dy);
        }
}

// The squared difference beyond what noise explains, in units of the noise [Bitterli2016, eq. 4].
void PatchWeights::measure(const Guide& guide, const Tile& tile, int dx, int dy) {
    const float scale = 1 / static_cast<float>(guide.values.size());
    const int width = (tile.width + kPatch - 1 + kLanes - 1) / kLanes * kLanes;
    for (int y = 0; y < tile.height + kPatch - 1; ++y) {
        float* const distances = distances_.data() + y * kStride;
        const int py = tile.y0 + y - kPatchRadius, px = tile.x0 - kPatchRadius;
        for (int x = 0; x < width; x += kLanes) {
            Lanes sum{};
            for (std::size_t c = 0; c < guide.values.size(); ++c) {
                const float* const values = guide.values[c]->row(py) + px + x;
                const float* const variances = guide.variances[c]->row(py) + px + x;
                const std::ptrdiff_t step = guide.values[c]->row(dy) + dx - guide.values[c]->row(0);
                const Lanes difference = load(values) - load(values + step);
                const Lanes vp = load(variances), vq = load(variances + step);
                sum += (difference * difference - (vp + min(vp, vq))) / (guide.epsilon + vp + vq);
            }
            store(distances + x, sum * scale);
        }
    }
}

void PatchWeights::average(const Tile& tile, int dx, int dy) {
    constexpr float kBandwidth = 2; // k
    constexpr float kScale = 1 / (kBandwidth * kBandwidth * kPatch * kPatch);
    for (int y = 0; y < tile.height + kPatch - 1; ++y) {
        float* const d = distances_.data() + y * kStride;
        for (int x = 0; x < tile.width; x += kLanes) { // in place: what is read lies at or right of what is written
            Lanes sum = load(d + x);
            for (int i = 1; i < kPatch; ++i) sum += load(d + x + i);
            store(d + x, sum);
        }
    }
    for (int y = 0; y < tile.height; ++y) {
        float* const weights = weights_.data() + offset(dx, dy, y);
        for (int x = 0; x < tile.width; x += kLanes) {
            Lanes sum{};
            for (int i = 0; i < kPatch; ++i) sum += load(distances_.data() + (y + i) * kStride + x);
            store(weights + x, decay(max(Lanes{}, sum * kScale)));
        }
    }
}

void PatchWeights::clip(const Guide& guide, const Tile& tile, int dx, int dy) {
    const int width = guide.values[0]->width(), height = guide.values[0]->height();
    // The columns of the tile for which both pixels lie inside.
    const int first = std::clamp(-dx - tile.x0, 0, tile.width);
    const int last = std::clamp(std::min(width, width - dx) - tile.x0, first, tile.width);
    for (int y = 0; y < tile.height; ++y) {
        float* const weights = weights_.data() + offset(dx, dy, y);
        const bool outside = tile.y0 + y + dy < 0 || tile.y0 + y + dy >= height;
        std::fill(weights, weights + (outside ? tile.width : first), 0.f);
        std::fill(weights + last, weights + tile.width, 0.f);
    }
}

HalfBuffers::HalfBuffers(std::vector<Plane> first, std::vector<Plane> second, int radius)
    : halves{std::move(first), std::move(second)} {
    for (std::size_t c = 0; c < halves[0].size(); ++c) {
        const Plane &a = halves[0][c], &b = halves[1][c];
        Plane variance(a.width(), a.height());
        parallelFor(static_cast<std::size_t>(a.height()), [&](std::size_t i) {
            const int y = static_cast<int>(i);
            for (int x = 0; x < a.width(); ++x) {
                const float difference = a.row(y)[x] - b.row(y)[x];
                variance.row(y)[x] = difference * difference / 2; // expects the variance of one half
            }
        });
        variance.extend();
        variances.push_back(boxFilter(variance, radius));
    }
}

Guide HalfBuffers::guide(std::size_t half, float epsilon) const { return guideOf(halves[half], variances, epsilon); }

Guide guideOf(const std::vector<Plane>& values, const std::vector<Plane>& variances, float epsilon) {
    Guide guide;
    guide.epsilon = epsilon;
    for (const Plane& p : values) guide.values.push_back(&p);
    for (const Plane& p : variances) guide.variances.push_back(&p);
    return guide;
}

std::vector<Plane> compressed(const std::vector<Plane>& colours) {
    std::vector<Plane> result = colours;
    for (Plane& plane : result) {
        parallelFor(static_cast<std::size_t>(plane.height()), [&](std::size_t i) {
            float* const row = plane.row(static_cast<int>(i));
            for (int x = 0; x < plane.width(); ++x) row[x] = std::asinh(row[x] / kDark);
        });
        plane.extend();
    }
    return result;
}

namespace {

float square(float x) { return x * x; }

} // namespace

ColourPlanes squaredError(const HalfBuffers& noisy, const DenoisedHalves& denoised) {
    ColourPlanes result;
    for (std::size_t c = 0; c < 3; ++c) {
        const Plane &a = noisy.halves[0][c], &b = noisy.halves[1][c], &da = denoised[0][c], &db = denoised[1][c];
        Plane error(a.width(), a.height());
        parallelFor(static_cast<std::size_t>(a.height()), [&](std::size_t i) {
            const int y = static_cast<int>(i);
            for (int x = 0; x < a.width(); ++x) {
                const float va = a.row(y)[x], vb = b.row(y)[x], wa = da.row(y)[x], wb = db.row(y)[x];
                // Var A and Var B are both (A − B)²/2.
                const float crossed = (square(wa - vb) + square(wb - va) - square(va - vb)) / 2;
                error.row(y)[x] = crossed - square(wa - wb) / 4;
            }
        });
        error.extend();
        result[c] = std::move(error);
    }
    return result;
}

Plane remainingNoise(const DenoisedHalves& denoised) {
    const int width = denoised[0][0].width(), height = denoised[0][0].height();
    Plane noise(width, height);
    parallelFor(static_cast<std::size_t>(height), [&](std::size_t i) {
        const int y = static_cast<int>(i);
        for (std::size_t c = 0; c < 3; ++c) {
            const float *a = denoised[0][c].row(y), *b = denoised[1][c].row(y);
            for (int x = 0; x < width; ++x) noise.row(y)[x] += square(a[x] - b[x]) / 12;
        }
    });
    noise.extend();
    return noise;
}

} // namespace abbe
