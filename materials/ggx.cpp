#include "materials/ggx.h"

#include <cstdint>

namespace abbe {
namespace {

#include "materials/data/ggx_albedo.inl"

using AlbedoGrid = GgxAlbedoGrid;

// Four neighbours of a position on an axis of `count` nodes and their weights: Catmull-Rom, with a straight
// continuation beyond both ends.
struct Neighbours {
    int index[4];
    float weight[4];

    Neighbours(float position, int count) {
        const float scaled = std::clamp(position, 0.f, 1.f) * static_cast<float>(count - 1);
        const int cell = std::min(static_cast<int>(scaled), count - 2);
        const float t = scaled - static_cast<float>(cell);
        weight[0] = 0.5f * t * (t * (2 - t) - 1);
        weight[1] = 1 + 0.5f * t * t * (3 * t - 5);
        weight[2] = 0.5f * t * (1 + t * (4 - 3 * t));
        weight[3] = 0.5f * t * t * (t - 1);
        for (int i = 0; i < 4; ++i) index[i] = std::clamp(cell - 1 + i, 0, count - 1);
        if (cell == 0) moveToLine(0, 1, 2);
        if (cell == count - 2) moveToLine(3, 2, 1);
    }

  private:
    void moveToLine(int outside, int end, int inside) {
        weight[end] += 2 * weight[outside];
        weight[inside] -= weight[outside];
        weight[outside] = 0;
    }
};

// Linear along mu, where the coordinate has made the function nearly straight between nodes.
template <int nodes> float row(const std::uint16_t* table, float position) {
    const float scaled = std::clamp(position, 0.f, 1.f) * (nodes - 1);
    const int cell = std::min(static_cast<int>(scaled), nodes - 2);
    const float a = table[cell], b = table[cell + 1];
    return a + (b - a) * (scaled - static_cast<float>(cell));
}

template <int nodes> float plane(const std::uint16_t* table, float position, const Neighbours& roughness) {
    float sum = 0;
    for (int i = 0; i < 4; ++i)
        if (roughness.weight[i] != 0)
            sum += roughness.weight[i] * row<nodes>(table + roughness.index[i] * nodes, position);
    return sum;
}

float widthOf(float alpha) { return std::max(alpha, static_cast<float>(AlbedoGrid::kMinAlpha)); }

} // namespace

float ggxAlbedo(float mu, float alpha) {
    const float x = AlbedoGrid::coordinate(mu, widthOf(alpha), 0.f);
    return plane<AlbedoGrid::kMu>(kMirrorAlbedo, x, {std::sqrt(alpha), AlbedoGrid::kRoughness}) * (1.f / 65535);
}

InterfaceShares<float> ggxInterface(float mu, float alpha, float eta) {
    const bool inside = eta < 1;
    const float contrast = std::abs(eta - 1) / (eta + 1);
    const Neighbours roughness(std::sqrt(alpha), AlbedoGrid::kRoughness);
    const Neighbours index(std::sqrt(contrast / static_cast<float>(AlbedoGrid::kMaxContrast)), AlbedoGrid::kEta);
    const float criticalMu = inside ? std::sqrt((1 - eta) * (1 + eta)) : 0;
    const float x = AlbedoGrid::coordinate(mu, widthOf(alpha), criticalMu);
    const std::uint16_t* turned = inside ? kInsideTurned : kOutsideTurned;
    const std::uint16_t* kept = inside ? kInsideKept : kOutsideKept;
    InterfaceShares<float> sum{0, 0};
    for (int i = 0; i < 4; ++i) {
        const float weight = index.weight[i] * (1.f / 65535);
        if (weight == 0) continue;
        const int plate = index.index[i] * AlbedoGrid::kRoughness;
        sum.turned += weight * plane<AlbedoGrid::kTurnedMu>(turned + plate * AlbedoGrid::kTurnedMu, x, roughness);
        sum.kept += 2 * weight * plane<AlbedoGrid::kMu>(kept + plate * AlbedoGrid::kMu, x, roughness);
    }
    // Nearly index-matched, grazing light is lost to the wrong side; the factors stay finite.
    sum.kept = std::max(sum.kept, 1e-3f);
    return sum;
}

} // namespace abbe
