#include "denoise/prepared_input.h"

#include "denoise/feature_filter.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// Three planes of the means and three of the halves.
struct Pairs {
    std::vector<Plane> mean, half;
};

bool isFinite(const Pairs& pairs, int x, int y) {
    const auto finite = [&](const Plane& p) { return std::isfinite(p.row(y)[x]); };
    return std::all_of(pairs.mean.begin(), pairs.mean.end(), finite) &&
           std::all_of(pairs.half.begin(), pairs.half.end(), finite);
}

// The mean of the finite pixels in the smallest square around (x, y) that has any; 0 if the picture has none.
void repairPixel(const Pairs& source, int x, int y, Pairs& result) {
    const int width = source.mean[0].width(), height = source.mean[0].height();
    for (std::size_t c = 0; c < source.mean.size(); ++c) result.mean[c].row(y)[x] = result.half[c].row(y)[x] = 0;
    int found = 0;
    for (int radius = 1; found == 0 && radius < 16; ++radius) {
        for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v)
            for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u) {
                if (!isFinite(source, u, v)) continue;
                ++found;
                for (std::size_t c = 0; c < source.mean.size(); ++c) {
                    result.mean[c].row(y)[x] += source.mean[c].row(v)[u];
                    result.half[c].row(y)[x] += source.half[c].row(v)[u];
                }
            }
    }
    for (std::size_t c = 0; found > 0 && c < source.mean.size(); ++c) {
        result.mean[c].row(y)[x] /= static_cast<float>(found);
        result.half[c].row(y)[x] /= static_cast<float>(found);
    }
}

std::uint64_t repair(Pairs& pairs) {
    std::uint64_t repaired = 0;
    const Pairs source = pairs;
    for (int y = 0; y < source.mean[0].height(); ++y)
        for (int x = 0; x < source.mean[0].width(); ++x)
            if (!isFinite(source, x, y)) {
                repairPixel(source, x, y, pairs);
                ++repaired;
            }
    for (std::vector<Plane>* planes : {&pairs.mean, &pairs.half})
        for (Plane& plane : *planes) plane.extend();
    return repaired;
}

Pairs pairsOf(const DenoiseInput& input, std::span<const DenoiseChannel> channels) {
    Pairs pairs;
    for (const DenoiseChannel& c : channels) {
        pairs.mean.emplace_back(input.width, input.height, c.mean);
        pairs.half.emplace_back(input.width, input.height, c.half.empty() ? c.mean : c.half);
    }
    return pairs;
}

template <typename F> void forEachPixel(Plane& plane, const F& change) {
    for (int y = 0; y < plane.height(); ++y)
        for (int x = 0; x < plane.width(); ++x) plane.row(y)[x] = change(plane.row(y)[x]);
    plane.extend();
}

void multiply(Pairs& pairs, float factor) {
    for (std::vector<Plane>* planes : {&pairs.mean, &pairs.half})
        for (Plane& plane : *planes) forEachPixel(plane, [&](float v) { return v * factor; });
}

// What makes the mean of all values `wanted`; 1 for a black picture.
float scaleTo(double wanted, const Pairs& pairs) {
    double sum = 0;
    for (const Plane& plane : pairs.mean)
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x) sum += std::abs(plane.row(y)[x]);
    const double count = static_cast<double>(pairs.mean.size()) * pairs.mean[0].width() * pairs.mean[0].height();
    return sum > 0 ? static_cast<float>(wanted * count / sum) : 1.f;
}

// The mean of both halves gives way to the second one.
HalfBuffers halvesOf(Pairs pairs) {
    for (std::size_t c = 0; c < pairs.mean.size(); ++c) {
        Plane& plane = pairs.mean[c];
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x) plane.row(y)[x] = 2 * plane.row(y)[x] - pairs.half[c].row(y)[x];
        plane.extend();
    }
    return {std::move(pairs.half), std::move(pairs.mean)};
}

std::vector<Plane> cleaned(Pairs pairs, bool filter) {
    return filter ? filterFeature(halvesOf(std::move(pairs)), kFeatureEpsilon) : std::move(pairs.mean);
}

void addFeature(const DenoiseInput& input, std::span<const DenoiseChannel> channels, bool filter,
                std::vector<Plane>& features) {
    if (channels[0].mean.empty()) return;
    Pairs pairs = pairsOf(input, channels);
    repair(pairs);
    for (Plane& plane : cleaned(std::move(pairs), filter)) features.push_back(std::move(plane));
}

// Where nothing is hit, depth is 0 or not finite: as far as the farthest surface. Logarithms make near and far alike.
void addDepth(const DenoiseInput& input, bool filter, std::vector<Plane>& features) {
    if (input.features.depth.mean.empty()) return;
    Pairs pairs = pairsOf(input, {&input.features.depth, 1});
    float farthest = 0;
    forEachPixel(pairs.mean[0], [&](float v) {
        if (std::isfinite(v)) farthest = std::max(farthest, v);
        return v;
    });
    for (std::vector<Plane>* planes : {&pairs.mean, &pairs.half})
        forEachPixel((*planes)[0], [&](float v) { return std::isfinite(v) && v > 0 ? v : farthest; });
    multiply(pairs, scaleTo(1, pairs));
    std::vector<Plane> depth = cleaned(std::move(pairs), filter);
    forEachPixel(depth[0], [](float v) { return std::log(std::max(v, 1e-6f)); });
    features.push_back(std::move(depth[0]));
}

} // namespace

PreparedInput prepare(const DenoiseInput& input, bool filterFeatures) {
    Pairs pairs = pairsOf(input, input.colour);
    const std::uint64_t repaired = repair(pairs);
    const float scale = scaleTo(0.25, pairs);
    multiply(pairs, scale);
    HalfBuffers colour = halvesOf(std::move(pairs));
    HalfBuffers guide(compressed(colour.halves[0]), compressed(colour.halves[1]));
    PreparedInput result{std::move(colour), std::move(guide), {}, scale, repaired};
    addFeature(input, input.features.albedo, filterFeatures, result.features);
    addFeature(input, input.features.normal, filterFeatures, result.features);
    addDepth(input, filterFeatures, result.features);
    return result;
}

} // namespace abbe
