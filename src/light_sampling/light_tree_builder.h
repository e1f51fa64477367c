// Where to divide the lights of a LightTree.
#pragma once

#include "base/parallel.h"
#include "render/light.h"

#include <cstdint>
#include <span>
#include <vector>

namespace abbe::light_tree {

// Of both: the box, the narrowest cones that hold both, and all their power.
LightBounds merged(const LightBounds&, const LightBounds&);

// Cost of looking into a node, relative to others: power × surface × solid angle that it may emit into
// [ContyEstevez2018, eq. 1].
double cost(const LightBounds&);

// Neighbours in the order of the leaves.
struct Run {
    std::uint32_t first = 0, count = 0;
    int depth = 0; // how often divided
    LightBounds bounds;
};

// Keeps the lights in the order of the tree's leaves, each subtree's together.
class Builder {
  public:
    // No run is divided more often, whatever the lights.
    static constexpr int kMaxDepth = 64;
    static constexpr std::size_t kBranches = 8;

    // Requires at least one light. Once `stop` is set it divides them anyhow, so that it comes to an end.
    explicit Builder(std::span<const LightBounds>, const StopFlag& stop = kNeverStop);

    Run all() const { return run(0, static_cast<std::uint32_t>(order_.size()), 0); }
    // Divides a run into eight, or into single lights if they are fewer, none empty.
    std::vector<Run> branches(const Run&);
    std::uint32_t light(std::uint32_t i) const { return order_[i]; }

  private:
    Run run(std::uint32_t first, std::uint32_t count, int depth) const;
    // Sorts a run of at least two into two and returns the size of the first, neither empty.
    std::uint32_t split(const Run&);

    bool toldToStop() const { return stop_.load(std::memory_order_relaxed); }

    std::span<const LightBounds> lights_;
    const StopFlag& stop_;
    std::vector<std::uint32_t> order_;
};

} // namespace abbe::light_tree
