// Makes the tree of BrickBounds from its lowest nodes upwards.
#pragma once

#include "volumes/brick_bounds.h"

#include <array>
#include <functional>
#include <span>

namespace abbe {

// The 8³ bricks of one node of level 1, z fastest. Where nothing is, the bounds are zeros.
using NodeBricks = std::array<FieldBounds, 512>;

class BrickTreeBuilder {
  public:
    // Place of a node of level 1: its first brick divided by 8.
    using Place = Vec3i;

    // All nodes of level 1 that may not be empty, without duplicates.
    explicit BrickTreeBuilder(std::vector<Place> places) : places_(std::move(places)) {}

    // Calls fill(place, bricks) for each node in parallel, then links the tree.
    template <typename Fill> BrickBounds build(const Fill& fill) {
        leaves_.resize(places_.size());
        forEachPlace([&](std::size_t i) {
            NodeBricks bricks{};
            fill(places_[i], bricks);
            store(leaves_[i], bricks);
        });
        return link();
    }

    // Of a finished tree, for building another from it.
    static std::vector<Place> placesOf(const BrickBounds& bounds);
    static FieldBounds brick(const BrickBounds& bounds, Vec3i globalBrick);

  private:
    struct Leaf {
        BrickBounds::Node node;
        std::vector<FieldBounds> bricks;
    };
    struct Placed {
        Vec3i place; // in units of its size, relative to the origin
        BrickBounds::Node node;
    };

    void forEachPlace(const std::function<void(std::size_t)>& body);
    static void store(Leaf& leaf, const NodeBricks& bricks);
    BrickBounds link();
    static std::vector<Placed> parents(BrickBounds& bounds, std::vector<Placed> level);
    static Placed parent(Vec3i place, std::span<const Placed> children, std::uint32_t first);
    static void visit(const BrickBounds& b, std::uint32_t node, int level, Vec3i place, std::vector<Place>& places);

    std::vector<Place> places_;
    std::vector<Leaf> leaves_;
};

} // namespace abbe
