// Rates of convergence: errors from replicates, and a straight line through logarithms.
#pragma once

#include "support/scene_test.h"

#include <cmath>
#include <vector>

namespace abbe::test {

// Mean squared error of `samples` samples, with the standard error of that.
struct RatePoint {
    double samples = 0, mse = 0, error = 0;
};
// Slope of log RMSE over log samples.
struct SlopeFit {
    double slope = 0, error = 0;
    double intercept = 0; // log RMSE of one sample
};

// Weighted least squares, each weight one over the variance of the logarithm.
inline SlopeFit fitSlope(const std::vector<RatePoint>& points) {
    double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const RatePoint& p : points) {
        const double x = std::log(p.samples), y = 0.5 * std::log(p.mse), sigma = 0.5 * p.error / p.mse;
        const double w = 1 / (sigma * sigma);
        sw += w;
        sx += w * x;
        sy += w * y;
        sxx += w * x * x;
        sxy += w * x * y;
    }
    const double determinant = sw * sxx - sx * sx;
    return {(sw * sxy - sx * sy) / determinant, std::sqrt(sw / determinant), (sxx * sy - sx * sxy) / determinant};
}

// Errors of renders with `first`, twice as many, … `last` samples. No reference is needed: the variance among
// replicates of n samples is the error of n samples, as long as the estimate is unbiased. The settings' samples are
// ignored.
inline std::vector<RatePoint> convergence(const TestScene& scene, RenderSettings settings, std::uint32_t first,
                                          std::uint32_t last, int replicates = 8) {
    std::vector<RatePoint> points;
    for (std::uint32_t n = first; n <= last; n *= 2) {
        settings.samples = n * static_cast<std::uint32_t>(replicates);
        settings.seed = n; // independent of the other rungs
        const TestImage image = render(scene, settings, {}, replicates);
        Moments variance;
        const PixelBounds b = image.film.bounds();
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x) variance.add(image.film.pixel(x, y).variance * replicates);
        // Pixels differ in their true variance, which is no error: s² of 8 replicates alone has a relative one of
        // √(2/7).
        const double error = variance.mean() * std::sqrt(2.0 / (replicates - 1) / variance.count());
        points.push_back({static_cast<double>(n), variance.mean(), error});
    }
    return points;
}

} // namespace abbe::test
