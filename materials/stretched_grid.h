// Directions of view on which tables of a stretched (anisotropic) GGX surface are laid out, and what is read between
// them.
#pragma once

#include "materials/ggx.h"
#include "math/vec.h"

#include <array>

namespace abbe {

// Immutable, thread-safe.
class StretchedGrid {
  public:
    static constexpr int kAzimuths = 13, kMu = 65;
    template <typename T> using Table = std::array<T, kAzimuths * kMu>;

    // Widths along x and y, above 0, at most √2; criticalMu: cosine beyond which the interface reflects totally, seen
    // from within a denser side; 0 if there is none.
    StretchedGrid(float alphaX, float alphaY, float criticalMu = 0)
        : alphaX_(alphaX), alphaY_(alphaY), criticalMu_(criticalMu) {}

    // α of the profile cut along wo.
    float widthTowards(Vec3 wo) const;

    // The table of f(direction of a node).
    template <typename T, typename F> void fill(Table<T>& table, F&& f) const {
        for (int a = 0; a < kAzimuths; ++a)
            for (int j = 0; j < kMu; ++j) table[static_cast<std::size_t>(a * kMu + j)] = f(direction(a, j));
    }
    // Between the four nodes around wo (unit, wo.z >= 0), of what `part` takes out of each.
    template <typename T, typename Part> auto at(const Table<T>& table, Vec3 wo, Part&& part) const {
        const Place p = find(wo);
        const T* low = &table[static_cast<std::size_t>(p.azimuth * kMu + p.mu)];
        const T* high = low + kMu;
        const auto between = [](auto a, auto b, float t) { return a + (b - a) * t; };
        return between(between(part(low[0]), part(low[1]), p.v), between(part(high[0]), part(high[1]), p.v), p.u);
    }

  private:
    struct Place {
        int azimuth, mu;
        float u, v; // within the cell
    };
    // Position along the azimuth in [0, 1]. What is tabulated changes over the azimuth itself and, on strongly
    // stretched surfaces, over the angle that the widths make of it: halfway between both, each has its nodes.
    float azimuthPosition(Vec3 wo) const;
    Vec3 direction(int azimuth, int mu) const;
    Place find(Vec3 wo) const;

    float alphaX_, alphaY_, criticalMu_;
};

// Calls f(m, share) for 1597 microfacets among those visible from wo, on a Fibonacci lattice that crowds towards the
// lower rim of the cap, where reflections begin to miss. The shares sum to 1, about.
template <typename F> void forVisibleMicrofacets(const Ggx& ggx, Vec3 wo, F&& f) {
    constexpr int count = 1597, step = 987; // Fibonacci numbers 17 and 16
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * step / count, 1.0), rim = (1 - t) * (1 - t);
        f(ggx.sampleVisible(wo, {static_cast<float>(u), static_cast<float>(1 - rim * (1 - t))}), 3 * rim / count);
    }
}

} // namespace abbe
