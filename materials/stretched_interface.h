// What one event at a stretched (anisotropic) rough interface of glass reflects and transmits together: the companion
// of ggxInterface, which knows surfaces of one width only.
#pragma once

#include "materials/stretched_grid.h"

namespace abbe {

// Tables over the direction of view for one pair of widths and one index, seen from either side; integrated on
// construction (about 0.2 s), immutable afterwards.
class StretchedInterface {
  public:
    // Widths as those of StretchedGrid; eta: inside over outside, > 0.
    StretchedInterface(float alphaX, float alphaY, float eta);

    float eta() const { return eta_; }
    // Shares of the light from wo (unit, wo.z >= 0) that leave a microfacet on either side and are not stopped by
    // others; from the inside if `within`.
    struct Shares {
        float reflected = 0, transmitted = 0;
    };
    Shares operator()(Vec3 wo, bool within) const {
        const Side& side = sides_[within ? 1 : 0];
        return {side.grid.at(side.table, wo, [](const Shares& s) { return s.reflected; }),
                side.grid.at(side.table, wo, [](const Shares& s) { return s.transmitted; })};
    }

  private:
    struct Side {
        StretchedGrid grid;
        StretchedGrid::Table<Shares> table;
    };
    static Side make(float alphaX, float alphaY, float eta);

    float eta_;
    std::array<Side, 2> sides_;
};

} // namespace abbe
