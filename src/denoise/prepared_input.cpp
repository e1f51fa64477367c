#include "denoise/prepared_input.h"

#include "denoise/plane.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr int kWindowRadius = 5;

// Adds half of the weighted means of `source` to `result`. Every pixel has the weight 1 to itself.
void addMeans(const PatchWeights& weights, const Tile& tile, const Plane& source, Plane& result) {
    for (int y = 0; y < tile.height; ++y)
        for (int x = 0; x < tile.width; x += kLanes) {
            Lanes sum{}, total{};
            for (int dy = -kWindowRadius; dy <= kWindowRadius; ++dy)
                for (int dx = -kWindowRadius; dx <= kWindowRadius; ++dx) {
                    const Lanes w = load(weights.row(dx, dy, y) + x);
                    sum += w * load(source.row(tile.y0 + y + dy) + tile.x0 + x + dx);
                    total += w;
                }
            float* const to = result.row(tile.y0 + y) + tile.x0 + x;
            store(to, load(to) + 0.5f * sum / max(total, splat(1e-30f)));
        }
}

} // namespace

std::vector<Plane> filterFeature(const HalfBuffers& feature, float epsilon) {
    const int width = feature.variances[0].width(), height = feature.variances[0].height();
    std::vector<Plane> result(feature.variances.size(), Plane(width, height));
    const std::array<Guide, 2> guides{feature.guide(0, epsilon), feature.guide(1, epsilon)};
    forEachTile(width, height, [&](const Tile& tile) {
        PatchWeights weights(kWindowRadius);
        for (std::size_t half = 0; half < 2; ++half) {
            weights.compute(guides[1 - half], tile);
            for (std::size_t c = 0; c < result.size(); ++c) addMeans(weights, tile, feature.halves[half][c], result[c]);
        }
    });
    for (Plane& plane : result) plane.extend();
    return result;
}

namespace {

// What variances are averaged over. Features are noisy at edges alone, and noise there is no reason to blur beside
// them.
constexpr int kColourRadius = 2, kFeatureRadius = 1;
constexpr float kLeastAlbedo = 0.003f; // is added, so that black surfaces can be divided by it
constexpr float kNoSurface = 0.02f;    // an albedo below this is none
constexpr float kBrightShading = 30;   // brighter is a light or its image; what most surfaces get is 0.5, say
constexpr float kFading = 100;         // one such pixel of 100, and none is divided any more

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

// What makes the median brightness of the pixels that are not black kTypical: a mean would follow the few pixels that
// show a light.
float scaleToTypical(const Pairs& colour) {
    std::vector<float> values;
    for (int y = 0; y < colour.mean[0].height(); ++y)
        for (int x = 0; x < colour.mean[0].width(); ++x) {
            const float sum = colour.mean[0].row(y)[x] + colour.mean[1].row(y)[x] + colour.mean[2].row(y)[x];
            if (sum > 0) values.push_back(sum / 3);
        }
    if (values.empty()) return 1;
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return kTypical / *middle;
}

// The mean of both halves gives way to the second one.
HalfBuffers halvesOf(Pairs pairs, int radius) {
    for (std::size_t c = 0; c < pairs.mean.size(); ++c) {
        Plane& plane = pairs.mean[c];
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x) plane.row(y)[x] = 2 * plane.row(y)[x] - pairs.half[c].row(y)[x];
        plane.extend();
    }
    return {std::move(pairs.half), std::move(pairs.mean), radius};
}

std::vector<Plane> cleaned(Pairs pairs, bool filter) {
    return filter ? filterFeature(halvesOf(std::move(pairs), kFeatureRadius), kFeatureEpsilon) : std::move(pairs.mean);
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

template <typename F> void forEachPair(ColourPlanes& colours, const ColourPlanes& factors, const F& combined) {
    for (std::size_t c = 0; c < 3; ++c) {
        Plane& plane = colours[c];
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x) plane.row(y)[x] = combined(plane.row(y)[x], factors[c].row(y)[x]);
        plane.extend();
    }
}

// How much of what is around a pixel is light that no albedo explains: lights, skies, mirror images of lights.
Plane unexplained(const HalfBuffers& colour, const std::vector<Plane>& albedo) {
    constexpr int kRadius = 10;
    Plane found(albedo[0].width(), albedo[0].height());
    for (int y = 0; y < found.height(); ++y)
        for (int x = 0; x < found.width(); ++x) {
            float light = 0, reflected = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                light += (colour.halves[0][c].row(y)[x] + colour.halves[1][c].row(y)[x]) / 6;
                reflected += albedo[c].row(y)[x] / 3;
            }
            const bool explained = reflected > kNoSurface && light < kBrightShading * reflected;
            found.row(y)[x] = explained ? 0.f : 1.f;
        }
    found.extend();
    return boxFilter(boxFilter(found, kRadius), kRadius);
}

// Near unexplained light the albedo fades: at the rim of a light that of a pixel says nothing about its light. The
// first three features are the albedo, if it is there.
Modulation modulationOf(const HalfBuffers& colour, const std::vector<Plane>& features) {
    const int width = colour.variances[0].width(), height = colour.variances[0].height();
    Modulation modulation;
    for (std::size_t c = 0; c < 3; ++c) {
        modulation.albedo[c] = features.empty() ? Plane(width, height) : features[c];
        forEachPixel(modulation.albedo[c],
                     [&](float v) { return features.empty() ? 1.f : std::max(v, 0.f) + kLeastAlbedo; });
    }
    modulation.fade = features.empty() ? Plane(width, height) : unexplained(colour, features);
    forEachPixel(modulation.fade, [](float v) { return std::min(1.f, kFading * v); });
    return modulation;
}

ColourPlanes divisorOf(const Modulation& modulation) {
    ColourPlanes divisor = modulation.albedo;
    for (Plane& plane : divisor) {
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x)
                plane.row(y)[x] += modulation.fade.row(y)[x] * (1 - plane.row(y)[x]);
        plane.extend();
    }
    return divisor;
}

std::vector<Plane> divided(const std::vector<Plane>& colours, const ColourPlanes& albedo) {
    ColourPlanes result{colours[0], colours[1], colours[2]};
    divide(result, albedo);
    return {std::move(result[0]), std::move(result[1]), std::move(result[2])};
}

} // namespace

void multiply(ColourPlanes& colours, const ColourPlanes& factors) {
    forEachPair(colours, factors, [](float a, float b) { return a * b; });
}

void divide(ColourPlanes& colours, const ColourPlanes& factors) {
    forEachPair(colours, factors, [](float a, float b) { return a / b; });
}

PreparedInput prepare(const DenoiseInput& input, bool filterFeatures) {
    Pairs pairs = pairsOf(input, input.colour);
    const std::uint64_t repaired = repair(pairs);
    const float scale = scaleToTypical(pairs);
    multiply(pairs, scale);
    HalfBuffers colour = halvesOf(std::move(pairs), kColourRadius);
    std::vector<Plane> features;
    addFeature(input, input.features.albedo, filterFeatures, features);
    Modulation modulation = modulationOf(colour, features);
    ColourPlanes divisor = divisorOf(modulation);
    std::array<std::vector<Plane>, 2> shading{divided(colour.halves[0], divisor), divided(colour.halves[1], divisor)};
    HalfBuffers guide(compressed(shading[0]), compressed(shading[1]), kColourRadius);
    addFeature(input, input.features.normal, filterFeatures, features);
    addDepth(input, filterFeatures, features);
    return {std::move(colour),
            std::move(modulation),
            std::move(divisor),
            std::move(shading),
            std::move(guide),
            std::move(features),
            scale,
            repaired};
}

NoisyInput noisyInput(const DenoiseInput& input) {
    Pairs pairs = pairsOf(input, input.colour);
    const std::uint64_t repaired = repair(pairs);
    const float scale = scaleToTypical(pairs);
    multiply(pairs, scale);
    NoisyInput result{halvesOf(std::move(pairs), kColourRadius), {}, {}, scale, repaired};
    const auto feature = [&](std::span<const DenoiseChannel> channels, std::optional<HalfBuffers>& halves) {
        if (channels[0].mean.empty()) return;
        Pairs found = pairsOf(input, channels);
        repair(found);
        halves = halvesOf(std::move(found), kFeatureRadius);
    };
    feature(input.features.albedo, result.albedo);
    feature(input.features.normal, result.normal);
    return result;
}

PreparedInput undivided(const PreparedInput& input) {
    Plane one = input.modulation.fade;
    forEachPixel(one, [](float) { return 1.f; });
    one.extend();
    Modulation modulation{{one, one, one}, one};
    ColourPlanes divisor = modulation.albedo;
    HalfBuffers guide(compressed(input.colour.halves[0]), compressed(input.colour.halves[1]), kColourRadius);
    return {input.colour,     std::move(modulation), std::move(divisor), input.colour.halves,
            std::move(guide), input.features,        input.scale,        input.repaired};
}

} // namespace abbe
