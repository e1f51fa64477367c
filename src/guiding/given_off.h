// What surfaces give off, as pilots have found it.
#pragma once

#include "guiding/guide_training.h"

namespace abbe {

// Means over small cells of surfaces that scatter light from everywhere: light that was found at any vertex spreads
// from cell to cell along all paths. So one path tells as much of the light from a direction as all that came by where
// it leads to [Dahm2017, of the same idea]. Cells see no direction: what glossy coats do is a mean.
class GivenOff {
  public:
    // `vertices` outlives it.
    explicit GivenOff(std::span<const PilotVertex> vertices);
    // From the direction in which the path goes on at a vertex; light as PilotVertex has it.
    float arriving(std::size_t vertex) const;

  private:
    static constexpr std::uint32_t kNone = 0xffffffff;
    float byItself(std::size_t vertex) const;
    void spread(std::size_t cells);

    std::span<const PilotVertex> vertices_;
    std::vector<std::uint32_t> cells_; // of vertices
    std::vector<float> radiance_;      // of cells
};

} // namespace abbe
