// What leads from one direction to another: a delta lobe, or a microfacet that refracts.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

namespace abbe {

// Which delta lobe leads from one direction to another.

// Their tangential parts tell, to 1e-4: directions come through frames in single precision.
inline bool nearlyEqual(Vec2 a, Vec2 b) { return square(a.x - b.x) + square(a.y - b.y) < 1e-8f; }
inline bool isMirrored(Vec3 wo, Vec3 wi) { return wo.z * wi.z > 0 && nearlyEqual({wi.x, wi.y}, {-wo.x, -wo.y}); }
inline bool isStraight(Vec3 wo, Vec3 wi) { return wo.z * wi.z < 0 && nearlyEqual({wi.x, wi.y}, {-wo.x, -wo.y}); }
// `eta`: index of the far side over that of wo's side.
inline bool isRefracted(Vec3 wo, Vec3 wi, float eta) {
    const float scale = 1 / std::max(eta, 1.f); // of the larger of both tangents
    return wo.z * wi.z < 0 && nearlyEqual(Vec2{wi.x, wi.y} * (eta * scale), Vec2{-wo.x, -wo.y} * scale);
}

// The microfacets off which light is refracted from one direction into another, one for each wavelength.

// For wo.z > 0 > wi.z and the index eta of the far side over the near one: h ∥ wo + η wi [Walter2007]. Where no
// microfacet does it, `possible` is false and the rest has no meaning.
struct RefractingHalves {
    Float8 hx, hy, hz; // unit, hz > 0
    Float8 cosO, cosI; // h·wo > 0 > h·wi where possible
    Float8 length2;    // of wo + η wi, bounded from below: it is 0 for wi = -wo and η = 1
    Int8 possible;

    RefractingHalves(Vec3 wo, Vec3 wi, Spectrum eta) {
        const Float8 x = wo.x + eta.v * wi.x, y = wo.y + eta.v * wi.y, z = wo.z + eta.v * wi.z;
        length2 = max(Spectrum(x * x + y * y + z * z), Spectrum(1e-20f)).v;
        const Float8 unit = (z < 0.f ? -1.f : 1.f) / sqrt(Spectrum(length2)).v;
        hx = x * unit, hy = y * unit, hz = z * unit;
        cosO = wo.x * hx + wo.y * hy + wo.z * hz;
        cosI = wi.x * hx + wi.y * hy + wi.z * hz;
        possible = (cosO > 0.f) & (cosI < 0.f);
    }

    // D(h) (h·wo) |dh/dwi| of GGX with widths ax and ay, where |dh/dwi| = η² |wi·h| / |wo + η wi|² [Walter2007, eq.
    // 17]: the length of the sum itself stands for the difference of products in their denominator.
    Spectrum density(float ax, float ay, Spectrum eta) const {
        const Float8 sx = hx * (1 / ax), sy = hy * (1 / ay), slope2 = sx * sx + sy * sy + hz * hz;
        return (1 / (kPi * ax * ay)) / (slope2 * slope2) * cosO * (eta * eta).v * -cosI / length2;
    }
};

} // namespace abbe
