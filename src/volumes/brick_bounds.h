// What a voxel field can be at most, at least and on average, brick by brick.
#pragma once

#include "volumes/voxel_grid.h"

#include <bit>
#include <cstdint>
#include <vector>

namespace abbe {

// Of the trilinearly interpolated field over a region. Equal for a constant region, where sampling gives the same
// value.
struct FieldBounds {
    float minimum = 0, mean = 0, maximum = 0;
};

// A brick is 8³ cells between voxel centres: index space [8b, 8b + 8) for a brick at b, the region of a leaf of the
// grid. Its bounds hold a thirtieth of a voxel beyond it too, so that points computed in float stay within them. Bricks
// where the field is 0 are not stored; the others are in a tree of 8³ children per node, with bounds at each level.
// Constant regions are single nodes. Immutable after build; far smaller than its grid (12 bytes a brick).
class BrickBounds {
  public:
    // With a `dilation` in voxels the bounds of a brick hold for all points that far away from it, along any axis: for
    // fields that are displaced or move during the shutter. Runs in parallel. Throws std::length_error for grids with a
    // constant value over more than about 10^10 bricks.
    // Finer ones, of 4³ or 2³ cells, are those of a grid whose index space is that of this one times 2^halvings, for
    // whoever looks them up: bounds are tighter, and there are more of them.
    // Requires: no voxel below 0, halvings 0 to 2.
    static BrickBounds build(const VoxelGrid& grid, float dilation = 0, int halvings = 0);

    bool empty() const { return nodes_.empty(); }
    std::size_t brickCount() const { return bricks_.size(); }
    std::size_t bytes() const;
    // Of the whole field.
    float maximum() const { return empty() ? 0 : nodes_[root_].bounds.maximum; }
    // Of the brick around a point in index space; zeros outside. For single lookups; rays use BrickWalk.
    FieldBounds at(Vec3 p) const;
    // Over a box of index space that is not empty: extremes that hold everywhere in it, and any mean between.
    FieldBounds over(const Bounds3d& box) const;

  private:
    friend class BrickWalk;
    friend class BrickTreeBuilder;

    static constexpr std::uint32_t kConstant = ~std::uint32_t{0};

    // A node of level n has children of 8^(n-1) bricks a side. Children lie one behind the other from `first` on:
    // bricks at level 1, else nodes; `rank` counts those before each 64 bits of the mask.
    struct Node {
        std::uint64_t mask[8] = {};
        std::uint16_t rank[8] = {};
        std::uint32_t first = 0; // kConstant: no children, the field is bounds.mean everywhere
        FieldBounds bounds;

        bool constant() const { return first == kConstant; }
        bool has(std::uint32_t child) const { return mask[child >> 6] >> (child & 63) & 1; }
        std::uint32_t index(std::uint32_t child) const {
            const std::uint64_t before = mask[child >> 6] & ((std::uint64_t{1} << (child & 63)) - 1);
            return first + rank[child >> 6] + static_cast<std::uint32_t>(std::popcount(before));
        }
    };

    // Bounds of a brick given relative to origin_; zeros where there is none.
    FieldBounds brick(std::uint32_t x, std::uint32_t y, std::uint32_t z) const;

    std::vector<Node> nodes_;
    std::vector<FieldBounds> bricks_;
    std::uint32_t root_ = 0;
    int levels_ = 0; // level of the root; at most 9
    Vec3i origin_;   // first brick of the root, multiple of 8
    Vec3i size_;     // there are no bricks from here on, relative to origin_
};

} // namespace abbe
