// What places of a scene give off, as pilots found it.
#pragma once

#include "guiding/space_tree.h"

namespace abbe {

// Means over small cells of what surfaces and media scatter, whatever the direction: as GivenOff has it. Frozen.
class RadianceCache {
  public:
    // `radiance`: of the leaves of `cells`.
    RadianceCache(SpaceTree cells, std::vector<float> radiance)
        : cells_(std::move(cells)), radiance_(std::move(radiance)) {}

    // Light as PilotVertex has it. `face`: as PathGuide::at() takes it.
    float at(Vec3 p, std::uint8_t face) const { return radiance_[cells_.leaf(p, face)]; }
    std::size_t bytes() const { return cells_.bytes() + radiance_.size() * sizeof(float); }

  private:
    SpaceTree cells_;
    std::vector<float> radiance_;
};

} // namespace abbe
