#include "math/key_grid.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// Of the distance between two steps: below the resolution of positions in float.
constexpr double kOnGrid = 1e-7;

KeyPosition snapped(KeyPosition p) {
    if (p.fraction < kOnGrid) return {p.key, 0};
    if (p.fraction > 1 - kOnGrid) return {p.key + 1, 0};
    return p;
}

bool onGrid(const std::vector<double>& positions, double parts) {
    return std::ranges::all_of(positions,
                               [&](double x) { return std::abs(x * parts - std::round(x * parts)) < kOnGrid; });
}

} // namespace

KeyPosition keyPosition(std::span<const double> times, double time) {
    ABBE_CHECK(!times.empty());
    if (time <= times.front()) return {0, 0};
    if (time >= times.back()) return {times.size() - 1, 0};
    const auto next = static_cast<std::size_t>(std::ranges::upper_bound(times, time) - times.begin());
    return {next - 1, (time - times[next - 1]) / (times[next] - times[next - 1])};
}

KeyGrid makeKeyGrid(std::span<const double> times, Interval interval, std::size_t maxSteps) {
    ABBE_CHECK(maxSteps >= 2 && interval.duration >= 0);
    KeyGrid grid;
    std::vector<std::size_t> inside;
    std::vector<double> positions; // of these, in the interval
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double x = (times[i] - interval.open) / interval.duration; // not finite for a duration of 0
        if (!(x > 0 && x < 1)) continue;
        inside.push_back(i);
        positions.push_back(x);
    }
    const KeyPosition first = snapped(keyPosition(times, interval.open));
    const KeyPosition last = snapped(keyPosition(times, interval.open + interval.duration));
    if (first == last) { // two states of different keys are never the same
        grid.steps.push_back(first);
        return grid;
    }
    std::size_t parts = 1;
    while (parts < maxSteps - 1 && !onGrid(positions, static_cast<double>(parts))) ++parts;
    const auto n = static_cast<double>(parts);
    for (std::size_t i = 0; i <= parts; ++i)
        grid.steps.push_back(
            snapped(keyPosition(times, interval.open + interval.duration * (static_cast<double>(i) / n))));
    if (onGrid(positions, n)) return grid;
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const double at = positions[i] * n, step = std::min(std::floor(at), n - 1);
        if (std::abs(at - std::round(at)) >= kOnGrid)
            grid.offGrid.push_back({inside[i], static_cast<std::size_t>(step), at - step});
    }
    return grid;
}

} // namespace abbe
