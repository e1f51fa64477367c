// GGX in double precision, written from the textbook formulas (Λ, G1, G2, half vectors) rather than the rearranged ones
// of materials/: what the renderer's code is compared with, and what its tables are made from.
#pragma once

#include "math/vec.h"

#include <cmath>
#include <complex>

namespace abbe::test {

// [Born1999, §1.5]; eta: far side over near side.
inline double referenceFresnel(double cosI, double eta) {
    const double sinT = std::sqrt(std::max(0.0, 1 - cosI * cosI)) / eta;
    if (sinT >= 1) return 1;
    const double cosT = std::sqrt(1 - sinT * sinT);
    const double rs = (cosI - eta * cosT) / (cosI + eta * cosT), rp = (eta * cosI - cosT) / (eta * cosI + cosT);
    return (rs * rs + rp * rp) / 2;
}
// The same with a complex index, by complex arithmetic in long double.
inline double referenceFresnel(double cosI, double n, double k) {
    using Complex = std::complex<long double>;
    const Complex index(n, k), one(1), cosine(cosI);
    const Complex g = std::sqrt(index * index - (one - cosine * cosine));
    const Complex rs = (cosine - g) / (cosine + g), rp = (index * index * cosine - g) / (index * index * cosine + g);
    return static_cast<double>((std::norm(rs) + std::norm(rp)) / 2);
}

struct ReferenceGgx {
    double alphaX, alphaY;

    double D(Vec3d m) const {
        if (m.z <= 0) return 0;
        const double s = square(m.x / alphaX) + square(m.y / alphaY) + m.z * m.z;
        return 1 / (kPiD * alphaX * alphaY * s * s);
    }
    double lambda(Vec3d v) const {
        const double tan2 = (square(alphaX * v.x) + square(alphaY * v.y)) / (v.z * v.z);
        return (std::sqrt(1 + tan2) - 1) / 2;
    }
    double G1(Vec3d v) const { return 1 / (1 + lambda(v)); }
    double G2(Vec3d a, Vec3d b) const { return 1 / (1 + lambda(a) + lambda(b)); }
    // Plain cap sampling of the visible normals [Dupuy2023].
    Vec3d visibleNormal(Vec3d wo, double u, double v) const {
        const Vec3d i = normalize(Vec3d{alphaX * wo.x, alphaY * wo.y, wo.z});
        const double z = (1 - v) * (1 + i.z) - i.z, r = safeSqrt(1 - z * z), phi = 2 * kPiD * u;
        return normalize(Vec3d{alphaX * (i.x + r * std::cos(phi)), alphaY * (i.y + r * std::sin(phi)), i.z + z});
    }
};

// Mean of f(m) over the normals visible from wo in the xz plane, by a Fibonacci lattice: total reflection begins at
// some angle, and a grid aligned with that circle would see it late. The two halves of the azimuth are alike; points
// crowd towards v = 1, the lower rim of the cap, where narrow lobes are cut off.
template <typename F> double meanOverVisible(const ReferenceGgx& ggx, Vec3d wo, F&& f) {
    constexpr int count = 10946, step = 6765; // Fibonacci numbers 21 and 20
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * step / count, 1.0);
        sum += 3 * (1 - t) * (1 - t) * f(ggx.visibleNormal(wo, u / 2, 1 - (1 - t) * (1 - t) * (1 - t)));
    }
    return sum / count;
}

// Share of the light that one bounce of an isotropic, perfectly reflecting rough mirror returns.
inline double referenceAlbedo(double mu, double alpha) {
    const ReferenceGgx ggx{alpha, alpha};
    const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
    return meanOverVisible(ggx, wo, [&](Vec3d m) {
        const Vec3d wi = m * (2 * dot(wo, m)) - wo;
        return wi.z > 0 ? ggx.G2(wo, wi) / ggx.G1(wo) : 0.0;
    });
}

// Shares that one event of an isotropic rough dielectric interface reflects and transmits.
struct ReferenceInterface {
    double reflected = 0, transmitted = 0;
};
inline ReferenceInterface referenceInterface(double mu, double alpha, double eta) {
    const ReferenceGgx ggx{alpha, alpha};
    const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
    ReferenceInterface sum;
    sum.reflected = meanOverVisible(ggx, wo, [&](Vec3d m) {
        const Vec3d wr = m * (2 * dot(wo, m)) - wo;
        return wr.z > 0 ? referenceFresnel(dot(wo, m), eta) * ggx.G2(wo, wr) / ggx.G1(wo) : 0.0;
    });
    sum.transmitted = meanOverVisible(ggx, wo, [&](Vec3d m) {
        const double c = dot(wo, m), reflectance = referenceFresnel(c, eta);
        if (!(reflectance < 1)) return 0.0;
        const Vec3d wt = m * (c / eta - safeSqrt(1 - (1 - c * c) / (eta * eta))) - wo * (1 / eta);
        return wt.z < 0 ? (1 - reflectance) * ggx.G2(wo, wt) / ggx.G1(wo) : 0.0;
    });
    return sum;
}

} // namespace abbe::test
