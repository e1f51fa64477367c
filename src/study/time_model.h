// What a render takes: seconds that more samples do not need, and seconds for each sample.
#pragma once

#include <optional>
#include <span>

namespace abbe {

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
