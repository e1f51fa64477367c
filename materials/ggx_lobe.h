// A GGX lobe with what energy compensation asks of it, for round and for stretched highlights.
#pragma once

#include "materials/ggx.h"
#include "materials/microfacet_cosines.h"
#include "materials/stretched_ggx.h"

namespace abbe {

class GgxLobe {
  public:
    // `stretched` and, for glass, `interface`: of the same widths; null if both widths are the same. They must outlive
    // the lobe.
    explicit GgxLobe(Ggx ggx, const StretchedLobe* stretched = nullptr, const StretchedInterface* interface = nullptr)
        : ggx_(ggx), stretched_(stretched), interface_(interface) {}

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
    // Whether the tables know a clear interface: round ones of indices up to 10, a stretched one that of one index.
    // eta: far side over near side, `within` if that is outside; `varies` if it differs between the lanes.
    bool tabulated(Spectrum eta, bool varies, bool within) const {
        if (smooth()) return true;
        if (maxLane(eta) > kMostEta || maxLane(Spectrum(1.f) / eta) > kMostEta) return false;
        if (!stretched_) return true;
        return interface_ && !varies && eta[0] == (within ? 1 / interface_->eta() : interface_->eta());
    }
    // Shares of reflection and transmission; if not tabulated, that of a round one of the width along wo.
    InterfaceShares<Spectrum> interface(Vec3 wo, Spectrum eta, bool varies, bool within) const {
        if (smooth()) return {Spectrum(0.5f), Spectrum(1.f)};
        const float alpha = width(wo);
        if (!varies) {
            const InterfaceShares<float> round = ggxInterface(wo.z, alpha, eta[0]);
            if (!interface_ || !tabulated(eta, varies, within)) return {Spectrum(round.turned), Spectrum(round.kept)};
            const auto [reflected, transmitted] = (*interface_)(wo, within);
            const float kept = 2 * (round.turned * reflected + (1 - round.turned) * transmitted);
            return {Spectrum(round.turned), Spectrum(std::max(kept, 1e-3f))};
        }
        Float8 turned, kept;
        for (int i = 0; i < kLanes; ++i) {
            const InterfaceShares<float> lane = ggxInterface(wo.z, alpha, eta[i]);
            turned[i] = lane.turned, kept[i] = lane.kept;
        }
        return {Spectrum(turned), Spectrum(kept)};
    }

    // α of the profile cut along wo.
    float width(Vec3 wo) const {
        const float sine2 = wo.x * wo.x + wo.y * wo.y;
        if (ggx_.alphaX() == ggx_.alphaY()) return std::min(ggx_.alphaX(), 1.f);
        if (!(sine2 > 0)) return std::min(1.f, std::sqrt(0.5f * (square(ggx_.alphaX()) + square(ggx_.alphaY()))));
        return std::min(1.f, std::sqrt((square(ggx_.alphaX() * wo.x) + square(ggx_.alphaY() * wo.y)) / sine2));
    }
    // Of the cosines at which its microfacets are hit, about.
    float spread(Vec3 wo) const { return width(wo) * std::sqrt(wo.x * wo.x + wo.y * wo.y); }

  private:
    static constexpr float kMostEta = 10.001f; // of the tables
    Ggx ggx_;
    const StretchedLobe* stretched_;
    const StretchedInterface* interface_;
};

} // namespace abbe
