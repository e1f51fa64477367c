#include "materials/microfacet_cosines.h"

#include "materials/ggx_albedo.h"

#include <cstdint>

namespace abbe {
namespace {

#include "materials/data/microfacet_cosines.inl"

using CosineGrid = MicrofacetCosineGrid;

Spectrum node(const std::int16_t* table, int roughness, int mu) {
    const std::int16_t* row = table + (roughness * CosineGrid::kMu + mu) * 8;
    const __m128i packed = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row));
    return Spectrum(_mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(packed)));
}

Spectrum between(Spectrum a, Spectrum b, float t) { return fma(b - a, Spectrum(t), a); }

// The cell of a position in [0, 1] among `count` nodes; `position` becomes the place within the cell.
int cellOf(float& position, int count) {
    const float scaled = std::clamp(position, 0.f, 1.f) * static_cast<float>(count - 1);
    const int cell = std::min(static_cast<int>(scaled), count - 2);
    position = scaled - static_cast<float>(cell);
    return cell;
}

Spectrum lookUp(const std::int16_t* table, float mu, float alpha) {
    const float width = std::max(alpha, static_cast<float>(GgxAlbedoGrid::kMinAlpha));
    float x = GgxAlbedoGrid::coordinate(mu, width, 0.f), y = std::sqrt(std::min(alpha, 1.f));
    const int i = cellOf(x, CosineGrid::kMu), j = cellOf(y, CosineGrid::kRoughness);
    const Spectrum low = between(node(table, j, i), node(table, j, i + 1), x);
    const Spectrum high = between(node(table, j + 1, i), node(table, j + 1, i + 1), x);
    const Spectrum scale(width * static_cast<float>(1 / CosineGrid::kScale));
    return min(max(fma(between(low, high, y), scale, Spectrum(mu)), Spectrum(0.f)), Spectrum(1.f));
}

} // namespace

Spectrum microfacetCosines(float mu, float alpha) { return lookUp(kMicrofacetCosines, mu, alpha); }

} // namespace abbe
