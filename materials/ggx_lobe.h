// A GGX lobe with what energy compensation asks of it, for round and for stretched highlights.
#pragma once

#include "materials/ggx.h"
#include "materials/ggx_albedo.h"
#include "materials/microfacet_cosines.h"
#include "materials/stretched_lobe.h"

namespace abbe {

class GgxLobe {
  public:
    // `stretched`: of the same widths; null if both are the same. It must outlive the lobe.
    explicit GgxLobe(Ggx ggx, const StretchedLobe* stretched = nullptr) : ggx_(ggx), stretched_(stretched) {}

    const Ggx& ggx() const { return ggx_; }
    bool smooth() const { return ggx_.smooth(); }

    // Share that a perfect mirror of this shape returns after one bounce; wo.z >= 0.
    float mirrorAlbedo(Vec3 wo) const {
        if (smooth()) return 1;
        return stretched_ ? stretched_->mirrorAlbedo(wo) : ggxAlbedo(wo.z, width(wo));
    }
    // See microfacetCosines().
    Spectrum cosines(Vec3 wo) const {
        if (smooth()) return Spectrum(wo.z);
        return stretched_ ? stretched_->cosines(wo) : microfacetCosines(wo.z, width(wo));
    }
    // See visibleCosines(); a stretched lobe is taken for its profile along wo.
    Spectrum visible(Vec3 wo) const { return smooth() ? Spectrum(wo.z) : visibleCosines(wo.z, width(wo)); }
    // Share that a clear interface of this shape reflects and transmits together; eta: far side over near side. The
    // table knows round lobes: a stretched one is taken to lose what its profile along wo would.
    Spectrum interfaceAlbedo(Vec3 wo, Spectrum eta, bool varies) const {
        if (smooth()) return Spectrum(1.f);
        const float alpha = width(wo);
        if (!varies) return Spectrum(ggxAlbedo(wo.z, alpha, eta[0]));
        Float8 result;
        for (int i = 0; i < kLanes; ++i) result[i] = ggxAlbedo(wo.z, alpha, eta[i]);
        return result;
    }

  private:
    // α of the profile cut along wo.
    float width(Vec3 wo) const {
        const float sine2 = wo.x * wo.x + wo.y * wo.y;
        if (ggx_.alphaX() == ggx_.alphaY()) return std::min(ggx_.alphaX(), 1.f);
        if (!(sine2 > 0)) return std::min(1.f, std::sqrt(0.5f * (square(ggx_.alphaX()) + square(ggx_.alphaY()))));
        return std::min(1.f, std::sqrt((square(ggx_.alphaX() * wo.x) + square(ggx_.alphaY() * wo.y)) / sine2));
    }

    Ggx ggx_;
    const StretchedLobe* stretched_;
};

} // namespace abbe
