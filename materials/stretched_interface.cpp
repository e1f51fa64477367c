#include "materials/stretched_interface.h"

#include "materials/fresnel.h"

#include <algorithm>

namespace abbe {
namespace {

// Share of the light from wo that leaves a microfacet on either side and is not stopped, G2/G1.
float kept(const Ggx& ggx, Vec3 wo, Vec3 m, float eta) {
    const float c = std::min(dot(wo, m), 1.f), reflected = fresnelDielectric(c, Spectrum(eta))[0];
    const auto escaping = [&](Vec3 wi) { return ggx.maskingOverCosine(wo, wi) / ggx.visible(wo); };
    float sum = 0;
    if (const Vec3 wi = reflect(wo, m); wi.z > 0) sum += reflected * escaping(wi);
    const float g2 = (eta - 1) * (eta + 1) + c * c;
    if (!(g2 > 0)) return sum;
    if (const Vec3 wi = (m * (c - std::sqrt(g2)) - wo) * (1 / eta); wi.z < 0) sum += (1 - reflected) * escaping(wi);
    return sum;
}

} // namespace

StretchedInterface::StretchedInterface(float alphaX, float alphaY, float eta)
    : eta_(eta), sides_{make(alphaX, alphaY, eta), make(alphaX, alphaY, 1 / eta)} {}

StretchedInterface::Side StretchedInterface::make(float alphaX, float alphaY, float eta) {
    Side side{StretchedGrid(alphaX, alphaY, eta < 1 ? std::sqrt((1 - eta) * (1 + eta)) : 0), {}};
    const Ggx ggx(alphaX, alphaY);
    side.grid.fill(side.table, [&](Vec3 wo) {
        double sum = 0;
        forVisibleMicrofacets(ggx, wo, [&](Vec3 m, double share) {
            if (dot(wo, m) > 0) sum += share * static_cast<double>(kept(ggx, wo, m, eta));
        });
        return static_cast<float>(std::clamp(sum, 1e-3, 1.0));
    });
    return side;
}

} // namespace abbe
