// Rates of convergence: a straight line through logarithms.
#pragma once

#include "support/statistics.h"

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

} // namespace abbe::test
