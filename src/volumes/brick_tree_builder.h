// Makes BrickBounds: the tree from its lowest nodes upwards, and those of fields that are known only point by point.
#pragma once

#include "math/bounds.h"
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

// Bounds of fields that are known only point by point.

// A field over index space that anyone can evaluate, but whose extremes over a region nobody knows. Thread-safe.
class PointField {
  public:
    virtual ~PointField() = default;
    // Finite, >= 0.
    virtual float at(Vec3d p) const noexcept = 0;
    // What the field certainly keeps to over a region, however wide; `mean` means nothing. Equal where the field is
    // constant.
    virtual FieldBounds limits(const Bounds3d& region) const = 0;
};

// Of bricks (0, 0, 0) up to `bricks`, from points within them: each brick is sampled in passes until a whole pass
// raises its extremes by next to nothing, as majorants are in progressive null tracking [Misso2023], and the extremes
// found are widened by a margin. Made once and then fixed, in any number of threads with the same result. The field may
// exceed such bounds: estimators that use them must stay unbiased then. Where the limits are not equal the bounds are
// not either, so that nothing escapes for ever.
BrickBounds sampleBounds(const PointField&, Vec3i bricks);

} // namespace abbe
