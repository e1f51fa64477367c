// Where to divide the lights of a LightTree.
#pragma once

#include "render/light_bounds.h"

#include <cstdint>
#include <span>
#include <vector>

namespace abbe::light_tree {

// Of both: the box, the narrowest cones that hold both, and all their power.
LightBounds merged(const LightBounds&, const LightBounds&);

// Cost of looking into a node, relative to others: power × surface × solid angle that it may shine into
// [ContyEstevez2018, eq. 1].
double cost(const LightBounds&);

// Keeps the lights in the order of the tree's leaves, each subtree's together.
class Builder {
  public:
    // No light is deeper, whatever the lights: a trail of turns has 64 bits.
    static constexpr int kMaxDepth = 64;

    explicit Builder(std::span<const LightBounds>);

    // Of a run of lights. Requires count > 0.
    LightBounds bounds(std::uint32_t first, std::uint32_t count) const;
    std::uint32_t light(std::uint32_t i) const { return order_[i]; }
    // Sorts a run of at least two into two and returns the size of the first, neither empty.
    std::uint32_t split(std::uint32_t first, std::uint32_t count, int depth);

  private:
    std::span<const LightBounds> lights_;
    std::vector<std::uint32_t> order_;
};

} // namespace abbe::light_tree
