// Tables of stretched (anisotropic) GGX surfaces: what one event returns, and at which angles.
#pragma once

#include "materials/ggx.h"
#include "math/vec.h"
#include "spectrum/spectrum.h"

#include <array>
#include <memory>

namespace abbe {

// Directions of view on which tables of a stretched (anisotropic) GGX surface are laid out, and what is read between
// them.

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

// What one bounce off a *stretched* (anisotropic) rough mirror keeps: the companion of ggxAlbedo, which knows surfaces
// of one width only.

// A table over the direction of view for one pair of widths, integrated on construction (about 60 ms), immutable
// afterwards. Off by less than 0.3 % where cos θ > 0.02, by less than 1 % below.
class StretchedAlbedo {
  public:
    // Widths along x and y, above 0, at most √2.
    StretchedAlbedo(float alphaX, float alphaY);

    // Share of the light from wo (unit, wo.z >= 0) that leaves again after one bounce.
    float operator()(Vec3 wo) const {
        return grid_.at(table_, wo, [](float share) { return share; });
    }

  private:
    StretchedGrid grid_;
    StretchedGrid::Table<float> table_;
};

// What one event at a stretched (anisotropic) rough interface of glass reflects and transmits together: the companion
// of ggxInterface, which knows surfaces of one width only.

// Tables over the direction of view for one pair of widths and one index, seen from either side; integrated on
// construction (about 0.2 s), immutable afterwards.
class StretchedInterface {
  public:
    // Widths as those of StretchedGrid; eta: inside over outside, > 0.
    StretchedInterface(float alphaX, float alphaY, float eta);

    float eta() const { return eta_; }
    // Shares of the light from wo (unit, wo.z >= 0) that leave a microfacet on either side and are not stopped by
    // others; from the inside if `within`.
    struct Shares {
        float reflected = 0, transmitted = 0;
    };
    Shares operator()(Vec3 wo, bool within) const {
        const Side& side = sides_[within ? 1 : 0];
        return {side.grid.at(side.table, wo, [](const Shares& s) { return s.reflected; }),
                side.grid.at(side.table, wo, [](const Shares& s) { return s.transmitted; })};
    }

  private:
    struct Side {
        StretchedGrid grid;
        StretchedGrid::Table<Shares> table;
    };
    static Side make(float alphaX, float alphaY, float eta);

    float eta_;
    std::array<Side, 2> sides_;
};

// What one bounce off a stretched (anisotropic) surface returns, and at which angles its microfacets reflect: the
// companion of ggxAlbedo and microfacetCosines, which know surfaces of one width only.

// A table over the direction of view for one pair of widths, integrated on construction (about 0.2 s), immutable
// afterwards.
class StretchedLobe {
  public:
    // Widths along x and y, above 0, at most √2.
    StretchedLobe(float alphaX, float alphaY);

    // As those of GgxLobe; wo unit, wo.z >= 0.
    float mirrorAlbedo(Vec3 wo) const;
    Spectrum cosines(Vec3 wo) const;

  private:
    struct Node {
        Spectrum reflected; // (c - mu)/width at the Gauss points
        float albedo = 0;
    };
    Node integrate(const Ggx&, Vec3 wo) const;
    Spectrum placed(Vec3 wo, Spectrum offset) const;

    StretchedGrid grid_;
    std::unique_ptr<StretchedGrid::Table<Node>> table_;
};

} // namespace abbe
