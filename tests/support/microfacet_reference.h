// The angles at which the microfacets of a rough mirror reflect, by brute force: what materials/microfacet_cosines is
// made from and compared with.
#pragma once

#include "support/ggx_reference.h"
#include "support/quadrature.h"

#include <algorithm>
#include <array>
#include <vector>

namespace abbe::test {

// Cosines at the Gauss points of the share of the reflected light; see materials/microfacet_cosines.h.
inline std::array<double, 8> referenceCosines(double mu, double alphaX, double alphaY, double azimuth = 0) {
    const ReferenceGgx ggx{alphaX, alphaY};
    const double sine = std::sqrt(1 - mu * mu);
    const Vec3d wo{sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
    struct Event {
        double cosine, share;
    };
    std::vector<Event> events;
    double total = 0;
    constexpr int count = 10946, step = 6765; // Fibonacci numbers 21 and 20, see meanOverVisible
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * step / count, 1.0);
        const Vec3d m = ggx.visibleNormal(wo, u, 1 - (1 - t) * (1 - t) * (1 - t));
        const double c = dot(wo, m);
        const Vec3d wi = m * (2 * c) - wo;
        if (!(wi.z > 0)) continue;
        const double kept = ggx.G2(wo, wi) / ggx.G1(wo);
        events.push_back({std::clamp(c, 0.0, 1.0), (1 - t) * (1 - t) * kept});
        total += events.back().share;
    }
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.cosine < b.cosine; });
    static const GaussLegendre<8> rule;
    std::array<double, 8> nodes = rule.node, result{};
    std::sort(nodes.begin(), nodes.end());
    double below = 0, previous = events.empty() ? mu : events.front().cosine;
    std::size_t k = 0;
    for (const Event& e : events) {
        const double middle = (below + e.share / 2) / total; // cosines belong to the middles of their shares
        for (; k < 8 && nodes[k] <= middle; ++k) result[k] = (previous + e.cosine) / 2;
        below += e.share;
        previous = e.cosine;
    }
    for (; k < 8; ++k) result[k] = previous;
    return result;
}

// Share of the light that an isotropic rough surface of reflectance F returns after one bounce.
template <typename F> double referenceReflection(double mu, double alpha, F&& reflectance) {
    const ReferenceGgx ggx{alpha, alpha};
    const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
    return meanOverVisible(ggx, wo, [&](Vec3d m) {
        const double c = dot(wo, m);
        const Vec3d wi = m * (2 * c) - wo;
        return wi.z > 0 ? reflectance(c) * ggx.G2(wo, wi) / ggx.G1(wo) : 0.0;
    });
}

} // namespace abbe::test
