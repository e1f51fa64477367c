// Light in a layer of upright fibres, followed photon by photon: what the table of the sheen lobe is made from and
// checked against.
#pragma once

#include "math/vec.h"

#include <cmath>
#include <numbers>
#include <optional>

namespace abbe {

// A slab of optical depth 1 (for light across the fibres) of mirroring microflakes whose normals are those of an
// ellipsoid that is stretched by 1/alpha along z: upright fibres for small alpha, dust for 1 [Zeltner2022, sec. 3;
// Heitz2015]. Nothing is absorbed. alpha in (0, 1].
class SheenLayer {
  public:
    explicit SheenLayer(double alpha) : alpha_(alpha) {}

    // The direction in which light that comes along -wo is thrown back; nothing if it leaves through the bottom.
    // `uniform()` gives numbers in [0, 1).
    template <typename Uniform> std::optional<Vec3d> reflect(Vec3d wo, Uniform&& uniform) const {
        Vec3d d = -wo;
        double depth = 0;
        for (;;) {
            // Projected area of the flakes seen along d [Heitz2015, eq. 4].
            const double extinction = length(scaled(d));
            depth -= d.z * -std::log(1 - uniform()) / extinction;
            if (depth < 0) return d;
            if (depth > 1) return std::nullopt;
            const Vec3d n = visibleNormal(-d, uniform(), uniform());
            d = normalize(d - n * (2 * dot(d, n)));
        }
    }

  private:
    Vec3d scaled(Vec3d w) const { return {w.x, w.y, w.z * alpha_}; }

    // The map that takes the ellipsoid to a sphere takes what is visible of it to a hemisphere, evenly in projected
    // area: cosine-weighted directions there are visible normals here.
    Vec3d visibleNormal(Vec3d w, double u, double v) const {
        const Vec3d t = normalize(scaled(w));
        const Vec3d side = normalize(std::abs(t.x) < 0.6 ? cross(t, Vec3d(1, 0, 0)) : cross(t, Vec3d(0, 1, 0)));
        const Vec3d up = cross(t, side);
        const double r = std::sqrt(u), phi = 2 * std::numbers::pi * v;
        return normalize(scaled(side * (r * std::cos(phi)) + up * (r * std::sin(phi)) + t * std::sqrt(1 - u)));
    }

    double alpha_;
};

} // namespace abbe
