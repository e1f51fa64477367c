// A place that light arrives at, as choosing and sampling lights see it.
#pragma once

#include "math/vec.h"

#include <array>
#include <cstddef>
#include <utility>

namespace abbe {

// A point of a surface or of a medium. With a normal, light from behind it counts for nothing, unless the surface
// lets light through: choosing and sampling lights may use that, and must not lose any light that counts.
struct Receiver {
    Receiver(Vec3 point) : p(point) {} // NOLINT: a point is a receiver of light from everywhere
    Receiver(Vec3 point, Vec3 normal, bool bothSides) : p(point), n(normal), surface(true), twoSided(bothSides) {}

    Vec3 p;
    Vec3 n;                // unit; that of the shading frame, on the side of the eye
    bool surface = false;  // whether n means anything
    bool twoSided = false; // light from behind n counts too

    // Light from behind n counts for nothing.
    bool oneSided() const { return surface && !twoSided; }
};

// How a surface scatters light, roughly. What choosing among lights needs to know of a Bsdf: the shares of its light
// that go evenly, by the cosine, and about the directions in which GGX microfacets mirror or refract wo. An estimate,
// which costs noise where it is wrong.
struct ScatterOutline {
    struct Glossy {
        float share = 0;
        float alpha2 = 1; // width of the microfacets' slopes, squared
        float eta = 1;    // refraction: index of the far side over that of wo's; 1: reflection
    };
    static constexpr int kMost = 2;

    float diffuse = 1;
    int count = 0; // of the glossy ones
    std::array<Glossy, kMost> glossy{};

    // One more; where there is no room the lesser ones count as diffuse.
    void add(Glossy lobe) {
        if (!(lobe.share > 0)) return;
        if (count < kMost) {
            glossy[static_cast<std::size_t>(count++)] = lobe;
            return;
        }
        for (Glossy& other : glossy)
            if (other.share < lobe.share) std::swap(other, lobe);
        diffuse += lobe.share;
    }
    // Another one, of which only a share is there.
    void add(const ScatterOutline& other, float share) {
        diffuse += share * other.diffuse;
        for (int i = 0; i < other.count; ++i) {
            Glossy lobe = other.glossy[static_cast<std::size_t>(i)];
            lobe.share *= share;
            add(lobe);
        }
    }
};

// The same, seen from a direction in render space.
struct ScatterView {
    Vec3 wo;
    ScatterOutline outline;

    bool glossy() const { return outline.count > 0; }
};

} // namespace abbe
