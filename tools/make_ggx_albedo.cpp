// Makes materials/data/ggx_albedo.inl (about four minutes of processor time):
//
//     g++ -std=c++20 -O3 -march=x86-64-v3 -Isrc -I. -Itests tools/make_ggx_albedo.cpp -o make_ggx_albedo -pthread
//     ./make_ggx_albedo > materials/data/ggx_albedo.inl
//
// tests/unit/materials/ggx_test.cpp recomputes part of it.
#include "materials/ggx.h"
#include "support/microfacet_walk.h"

#include <cstdio>
#include <future>
#include <vector>

namespace abbe {
namespace {

using Grid = GgxAlbedoGrid;

// The factor of reflection is at most 16: a few microfacets are not made to stand for all that is turned back after
// many events.
constexpr double kMostScale = 16;
// Of interfaces that are nearly none, of |η - 1|/(η + 1) below the first, one event counts only; from the second on all
// do. Otherwise the factors would change too fast from node to node.
constexpr double kFaint = 0.003, kClear = 0.1;

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

double alphaAt(int node) {
    const double roughness = node / (Grid::kRoughness - 1.0);
    return std::max(roughness * roughness, Grid::kMinAlpha);
}

double etaAt(int node) {
    const double t = node / (Grid::kEta - 1.0);
    const double contrast = std::max(Grid::kMaxContrast * t * t, 2e-4);
    return (1 + contrast) / (1 - contrast);
}

int stored(double share) { return static_cast<int>(std::lround(std::min(1.0, share) * 65535)); }

void print(const char* name, const std::vector<int>& values, int perLine) {
    std::printf("inline constexpr std::uint16_t %s[] = {\n", name);
    for (std::size_t i = 0; i < values.size(); ++i)
        std::printf("%d,%s", values[i], (i + 1) % static_cast<std::size_t>(perLine) ? "" : "\n");
    std::printf("};\n");
}

// The tables of one side of an interface.
class Side {
  public:
    explicit Side(bool inside) : inside_(inside) {
        for (int e = 0; e < Grid::kEta; ++e)
            for (int j = 0; j < Grid::kRoughness; ++j) {
                for (int i = 0; i < Grid::kTurnedMu; ++i) turned_.push_back(stored(turned(e, j, i * Grid::kMuStep)));
                for (int i = 0; i < Grid::kMu; ++i) kept_.push_back(stored(kept(e, j, i)));
            }
    }
    void print() const {
        abbe::print(inside_ ? "kInsideTurned" : "kOutsideTurned", turned_, Grid::kTurnedMu);
        abbe::print(inside_ ? "kInsideKept" : "kOutsideKept", kept_, Grid::kMu);
    }

  private:
    // Where both factors of one part are less, its scale does not matter, and its ratio would be noise.
    static constexpr double kLittle = 1e-4;
    double eta(int e) const { return inside_ ? 1 / etaAt(e) : etaAt(e); }
    double mu(int e, int j, int i) const { return muAt(i, alphaAt(j), inside_ ? std::sqrt(1 - eta(e) * eta(e)) : 0); }
    // w/(1 - w) = (r/A)/((1 - r)/B), where one event reflects A and transmits B, and r is to be reflected of all light.
    double turned(int e, int j, int i) const {
        const double m = mu(e, j, i), alpha = alphaAt(j);
        const test::ReferenceInterface once = test::referenceInterface(m, alpha, eta(e));
        double r = once.reflected;
        if (const double share = walkedShare(e); share > 0) {
            const test::WalkShares all = test::MicrofacetWalk(m, alpha, eta(e))(10946, 1);
            r += share * (all.reflected - all.firstReflected);
        }
        // And no more is transmitted than a like factor has; where that is nothing, the weight does not matter.
        r = std::clamp(r, 1 - kMostScale * once.transmitted, std::min(1.0, kMostScale * once.reflected));
        const double back = r * once.transmitted, through = (1 - r) * once.reflected;
        return (back + kLittle) / (back + through + 2 * kLittle);
    }
    // How much of what further events reflect counts.
    static double walkedShare(int e) {
        const double contrast = (etaAt(e) - 1) / (etaAt(e) + 1);
        const double t = std::clamp((contrast - kFaint) / (kClear - kFaint), 0.0, 1.0);
        return t * t * (3 - 2 * t);
    }
    // Half of InterfaceShares::kept, with the weight that is read between its nodes.
    double kept(int e, int j, int i) const {
        const int cell = std::min(i / Grid::kMuStep, Grid::kTurnedMu - 2);
        const int* table = &turned_[static_cast<std::size_t>((e * Grid::kRoughness + j) * Grid::kTurnedMu + cell)];
        const double t = i / static_cast<double>(Grid::kMuStep) - cell, w = std::lerp(table[0], table[1], t) / 65535;
        const test::ReferenceInterface once = test::referenceInterface(mu(e, j, i), alphaAt(j), eta(e));
        return w * once.reflected + (1 - w) * once.transmitted;
    }

    bool inside_;
    std::vector<int> turned_, kept_;
};

} // namespace
} // namespace abbe

int main() {
    using namespace abbe;
    std::printf("// Made by tools/make_ggx_albedo.cpp. Units of 1/65535; the layout is GgxAlbedoGrid's: "
                "[eta][roughness][mu]; `Kept` is halved.\n");
    std::vector<int> mirror;
    for (int j = 0; j < Grid::kRoughness; ++j)
        for (int i = 0; i < Grid::kMu; ++i)
            mirror.push_back(stored(test::referenceAlbedo(muAt(i, alphaAt(j), 0), alphaAt(j))));
    print("kMirrorAlbedo", mirror, Grid::kMu);
    auto outside = std::async(std::launch::async, [] { return Side(false); });
    const Side inside(true);
    outside.get().print();
    inside.print();
}
