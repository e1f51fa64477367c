// Makes materials/data/ggx_albedo.inl (about three minutes on one core):
//
//     g++ -std=c++20 -O3 -march=x86-64-v3 -Isrc -I. -Itests tools/make_ggx_albedo.cpp -o make_ggx_albedo
//     ./make_ggx_albedo > materials/data/ggx_albedo.inl
//
// tests/unit/materials/ggx_albedo_test.cpp recomputes part of it.
#include "materials/ggx_albedo.h"
#include "support/ggx_reference.h"

#include <cstdio>

namespace abbe {
namespace {

using Grid = GgxAlbedoGrid;

// The cosine at a position of the table, by bisection.
double muAt(int node, double alpha, double criticalMu) {
    const double x = node / (Grid::kMu - 1.0);
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (Grid::coordinate(middle, alpha, criticalMu) < x ? low : high) = middle;
    }
    return std::max(high, 1e-7);
}

template <typename F> void printTable(const char* name, int etas, F&& albedo) {
    std::printf("inline constexpr std::uint16_t %s[] = {\n", name);
    for (int e = 0; e < etas; ++e)
        for (int j = 0; j < Grid::kRoughness; ++j) {
            const double roughness = j / (Grid::kRoughness - 1.0);
            const double alpha = std::max(roughness * roughness, Grid::kMinAlpha);
            for (int i = 0; i < Grid::kMu; ++i) std::printf("%.0f,", std::min(1.0, albedo(e, alpha, i)) * 65535);
            std::printf("\n");
            std::fflush(stdout);
        }
    std::printf("};\n");
}

double etaAt(int node) {
    const double t = node / (Grid::kEta - 1.0);
    const double contrast = std::max(Grid::kMaxContrast * t * t, 2e-4);
    return (1 + contrast) / (1 - contrast);
}

} // namespace
} // namespace abbe

int main() {
    using namespace abbe;
    std::printf("// Made by tools/make_ggx_albedo.cpp. Units of 1/65535; the layout is GgxAlbedoGrid's: "
                "[eta][roughness][mu].\n");
    printTable("kMirrorAlbedo", 1,
               [](int, double alpha, int i) { return test::referenceAlbedo(muAt(i, alpha, 0), alpha); });
    printTable("kOutsideAlbedo", Grid::kEta, [](int e, double alpha, int i) {
        return test::referenceDielectricAlbedo(muAt(i, alpha, 0), alpha, etaAt(e));
    });
    printTable("kInsideAlbedo", Grid::kEta, [](int e, double alpha, int i) {
        const double eta = 1 / etaAt(e), criticalMu = std::sqrt(1 - eta * eta);
        return test::referenceDielectricAlbedo(muAt(i, alpha, criticalMu), alpha, eta);
    });
}
