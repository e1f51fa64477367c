#include "denoise/half_buffers.h"

#include "base/parallel.h"

#include <cmath>

namespace abbe {

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

} // namespace abbe
