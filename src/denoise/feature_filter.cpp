#include "denoise/feature_filter.h"

#include "denoise/lanes.h"

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

} // namespace abbe
