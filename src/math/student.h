// Student's distribution by way of the normal one [Wallace1959]: within a percent of probabilities down to 1e-9 from
// eight degrees of freedom on.
#pragma once

#include <cmath>
#include <numbers>

namespace abbe {

// The normal score that is as improbable as t with `freedom` degrees, of t's sign.
inline double studentScore(double t, double freedom) {
    const double size = std::sqrt(freedom * std::log1p(t * t / freedom)) * (8 * freedom + 1) / (8 * freedom + 3);
    return std::copysign(size, t);
}

// Its inverse. Requires score >= 0.
inline double studentOfScore(double score, double freedom) {
    const double size = score * (8 * freedom + 3) / (8 * freedom + 1);
    return std::sqrt(freedom * std::expm1(size * size / freedom));
}

// Probability of a normal score that is as far from 0 or farther.
inline double normalTwoSided(double score) { return std::erfc(std::abs(score) / std::numbers::sqrt2); }

// The score whose normalTwoSided() is p. Requires 0 < p <= 1.
inline double scoreOfTwoSided(double p) {
    double low = 0, high = 40;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (normalTwoSided(middle) > p ? low : high) = middle;
    }
    return (low + high) / 2;
}

} // namespace abbe
