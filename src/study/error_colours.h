// Colours for maps of errors.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace abbe {

// Cubehelix [Green2011]: a turn through the hues on which brightness rises evenly from black to white, so that
// nothing looks larger than it is, on paper and to colour-blind readers neither.
struct ErrorColours {
    static constexpr const char* kName = "cubehelix";
    // Display-encoded (sRGB), 0 … 1; of t clamped to 0 … 1.
    static std::array<float, 3> at(double t);
    // Interleaved, of values from `low` to `high`.
    static std::vector<float> paint(std::span<const float> values, double low, double high);
    // 0.1, 0.2, 0.5, 1, …: the least such number that 99 % of the values do not exceed. Requires some values.
    static double roundScale(std::vector<float> values);
};

} // namespace abbe
