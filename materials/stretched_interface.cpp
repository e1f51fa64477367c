#include "materials/stretched_interface.h"

#include "materials/fresnel.h"

#include <algorithm>

namespace abbe {
namespace {

// G2/G1 on either side of microfacet m, times what it reflects and what it lets through.
StretchedInterface::Shares kept(const Ggx& ggx, Vec3 wo, Vec3 m, float eta) {
    const float c = std::min(dot(wo, m), 1.f), reflected = fresnelDielectric(c, Spectrum(eta))[0];
    const auto escaping = [&](Vec3 wi) { return ggx.maskingOverCosine(wo, wi) / ggx.visible(wo); };
    StretchedInterface::Shares shares;
    if (const Vec3 wi = reflect(wo, m); wi.z > 0) shares.reflected = reflected * escaping(wi);
    const float g2 = (eta - 1) * (eta + 1) + c * c;
    if (!(g2 > 0)) return shares;
    if (const Vec3 wi = (m * (c - std::sqrt(g2)) - wo) * (1 / eta); wi.z < 0)
        shares.transmitted = (1 - reflected) * escaping(wi);
    return shares;
}

} // namespace

StretchedInterface::StretchedInterface(float alphaX, float alphaY, float eta)
    : eta_(eta), sides_{make(alphaX, alphaY, eta), make(alphaX, alphaY, 1 / eta)} {}

StretchedInterface::Side StretchedInterface::make(float alphaX, float alphaY, float eta) {
    Side side{StretchedGrid(alphaX, alphaY, eta < 1 ? std::sqrt((1 - eta) * (1 + eta)) : 0), {}};
    const Ggx ggx(alphaX, alphaY);
    side.grid.fill(side.table, [&](Vec3 wo) {
        double reflected = 0, transmitted = 0;
        forVisibleMicrofacets(ggx, wo, [&](Vec3 m, double share) {
            if (!(dot(wo, m) > 0)) return;
            const Shares s = kept(ggx, wo, m, eta);
            reflected += share * static_cast<double>(s.reflected);
            transmitted += share * static_cast<double>(s.transmitted);
        });
        return Shares{static_cast<float>(std::min(reflected, 1.0)), static_cast<float>(std::min(transmitted, 1.0))};
    });
    return side;
}

} // namespace abbe
