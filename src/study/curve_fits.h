// What is fitted to a curve: straight lines through errors on logarithmic scales, curves that flatten, and what a
// render takes: seconds that more samples do not need, and seconds for each sample.
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

// seconds = fixed + perSample · samples. Fixed are pilots, what is planned with them, and a denoiser. Where pictures
// are small they are most of the time, and say nothing of how fast errors fall.
struct TimeModel {
    double fixed = 0;     // s, not negative
    double perSample = 0; // s for one sample in every pixel, positive

    // Least squares of relative deviations. Nothing with fewer than two numbers of samples, or where time does not rise
    // with them. Requires equal sizes; samples, seconds > 0.
    static std::optional<TimeModel> fit(std::span<const double> samples, std::span<const double> seconds);

    double seconds(double samples) const { return fixed + perSample * samples; }
};

} // namespace abbe
