#include "denoise/error_estimate.h"

#include "base/parallel.h"

namespace abbe {

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
