#include "materials/stretched_albedo.h"

#include <algorithm>

namespace abbe {

// E(wo) = ∫ G2/G1 over the visible normals.
StretchedAlbedo::StretchedAlbedo(float alphaX, float alphaY) : grid_(alphaX, alphaY) {
    const Ggx ggx(alphaX, alphaY);
    grid_.fill(table_, [&](Vec3 wo) {
        double sum = 0;
        forVisibleMicrofacets(ggx, wo, [&](Vec3 m, double share) {
            const Vec3 wi = reflect(wo, m);
            if (wi.z > 0) sum += share * static_cast<double>(ggx.maskingOverCosine(wo, wi) / ggx.visible(wo));
        });
        return static_cast<float>(std::min(1.0, sum));
    });
}

} // namespace abbe
