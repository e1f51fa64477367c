#include "exchange/shared/ies_writer.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace abbe::exchange {

// Vertical angles count from the axis, which points down; the plane of 0° lies towards +x.
std::string iesFile(const std::function<double(Vec3d)>& candela) {
    constexpr int kVertical = 361, kHorizontal = 721;
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(kVertical) * kHorizontal);
    for (int h = 0; h < kHorizontal; ++h)
        for (int v = 0; v < kVertical; ++v) {
            const double theta = v * kPiD / (kVertical - 1), phi = h * 2 * kPiD / (kHorizontal - 1);
            values.push_back(std::max(
                candela({std::sin(theta) * std::cos(phi), -std::cos(theta), -std::sin(theta) * std::sin(phi)}), 0.0));
        }
    if (std::ranges::max(values) <= 0) return {};
    std::string text = "IESNA:LM-63-2002\nTILT=NONE\n";
    text += fmt::format("1 -1 1 {} {} 1 2 0 0 0\n1 1 0\n", kVertical, kHorizontal);
    for (int v = 0; v < kVertical; ++v) text += fmt::format("{}\n", 180.0 * v / (kVertical - 1));
    for (int h = 0; h < kHorizontal; ++h) text += fmt::format("{}\n", 360.0 * h / (kHorizontal - 1));
    for (const double value : values) text += fmt::format("{}\n", value);
    return text;
}

} // namespace abbe::exchange
