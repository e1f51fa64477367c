// Straight lines through errors on logarithmic scales, and curves that flatten.
#pragma once

#include <optional>
#include <span>

namespace abbe {

// y = exp(logAtOne) x^slope.
struct PowerLaw {
    double slope = 0, logAtOne = 0;

    // Weighted least squares of log y on log x. Nothing unless all x and y are positive and two x differ.
    // Requires equal sizes; weights > 0.
    static std::optional<PowerLaw> fit(std::span<const double> x, std::span<const double> y,
                                       std::span<const double> weights);
};

// y = floor + scale x^power: what an error comes to when samples alone no longer help.
struct FlooredLaw {
    // More of a power cannot be told from a floor by a few rungs, and a steeper one does not exist.
    static constexpr double kFlattest = -0.3, kSteepest = -3;

    double floor = 0, scale = 0, power = 0;

    // Least squares with the given standard errors of y, the power by search within the bounds above. The floor may
    // come out negative, the scale not. Nothing with fewer than four points. Requires equal sizes; x, errors > 0.
    static std::optional<FlooredLaw> fit(std::span<const double> x, std::span<const double> y,
                                         std::span<const double> errors);
};

} // namespace abbe
