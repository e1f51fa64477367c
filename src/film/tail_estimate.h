// Whether few values carry a sum of squares, and how much of it may not have been met yet.
#pragma once

#include <optional>
#include <vector>

namespace abbe {

// Errors are estimated from samples, and know nothing of bright ones that are too rare to have been met: a glossy
// surface that gathers a small lamp sends some of its light along paths that one sample in a million finds. The sizes
// of those that were met tell of the others. The largest values are fitted by a generalised Pareto distribution
// [Zhang2009], whose shape k is that of Pareto smoothed importance sampling [Vehtari2024]: beyond k = 1/4 their fourth
// moment has no bound, so that an interval made of it is too narrow; beyond 1/2 neither has their variance.
struct TailEstimate {
    // With more than this unseen, over the sum of squares, an error that was stated from it cannot be trusted: it may
    // be a quarter larger.
    static constexpr double kTrusted = 0.5;
    static constexpr std::size_t kLeast = 100; // values; fewer do not tell

    double shape = 0;   // k
    double largest = 0; // share of the largest value in the sum of squares
    // What is expected of the sum of squares beyond the largest value, over the sum: 0 where the tail is light.
    double unseen = 0;

    // Of sizes that are not negative; changes their order. Nothing for fewer than kLeast, or if hardly any is above 0.
    static std::optional<TailEstimate> of(std::vector<float>& sizes);
};

} // namespace abbe
