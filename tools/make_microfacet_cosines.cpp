// Makes materials/data/microfacet_cosines.inl (some ten seconds on one core):
//
//     g++ -std=c++20 -O3 -march=x86-64-v3 -Isrc -I. -Itests tools/make_microfacet_cosines.cpp -o
//     make_microfacet_cosines
//     ./make_microfacet_cosines > materials/data/microfacet_cosines.inl
//
// tests/unit/materials/microfacet_cosines_test.cpp recomputes part of it.
#include "materials/ggx.h"
#include "materials/microfacet_cosines.h"
#include "support/microfacet_reference.h"

#include <cstdio>

namespace abbe {
namespace {

using Grid = MicrofacetCosineGrid;

void printTable(const char* name) {
    std::printf("inline constexpr std::int16_t %s[] = {\n", name);
    for (int j = 0; j < Grid::kRoughness; ++j) {
        const double roughness = j / (Grid::kRoughness - 1.0);
        const double alpha = std::max(roughness * roughness, GgxAlbedoGrid::kMinAlpha);
        for (int i = 0; i < Grid::kMu; ++i) {
            double low = 0, high = 1; // the cosine at this position of the table, by bisection
            for (int k = 0; k < 60; ++k) {
                const double middle = (low + high) / 2;
                (GgxAlbedoGrid::coordinate(middle, alpha, 0.0) < i / (Grid::kMu - 1.0) ? low : high) = middle;
            }
            const double mu = std::max(high, 1e-7);
            for (const double c : test::referenceCosines(mu, alpha, alpha))
                std::printf("%.0f,", std::clamp((c - mu) / alpha * Grid::kScale, -32767.0, 32767.0));
        }
        std::printf("\n");
    }
    std::printf("};\n");
}

} // namespace
} // namespace abbe

int main() {
    std::printf("// Made by tools/make_microfacet_cosines.cpp. Units of 1/%g; the layout is MicrofacetCosineGrid's: "
                "[roughness][mu][point].\n",
                abbe::MicrofacetCosineGrid::kScale);
    abbe::printTable("kMicrofacetCosines");
}
