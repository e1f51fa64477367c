#include "study/error_colours.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {

// Start 0.5, −1.5 turns, hue 1, γ 1, as [Green2011] gives them.
std::array<float, 3> ErrorColours::at(double t) {
    t = std::clamp(t, 0.0, 1.0);
    const double angle = 2 * std::numbers::pi * (0.5 / 3 + 1 - 1.5 * t), strength = t * (1 - t) / 2;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto channel = [&](double a, double b) {
        return static_cast<float>(std::clamp(t + strength * (a * c + b * s), 0.0, 1.0));
    };
    return {channel(-0.14861, 1.78277), channel(-0.29227, -0.90649), channel(1.97294, 0)};
}

std::vector<float> ErrorColours::paint(std::span<const float> values, double low, double high) {
    std::vector<float> rgb;
    rgb.reserve(3 * values.size());
    for (const float v : values) {
        const auto colour = at((v - low) / (high - low));
        rgb.insert(rgb.end(), colour.begin(), colour.end());
    }
    return rgb;
}

double ErrorColours::roundScale(std::vector<float> values) {
    ABBE_CHECK(!values.empty());
    const auto rank = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), rank, values.end());
    const double wanted = std::max<double>(*rank, 1e-6);
    const double power = std::pow(10, std::floor(std::log10(wanted)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= wanted) return step * power;
    return 10 * power;
}

} // namespace abbe
