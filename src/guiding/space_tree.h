// Places of surfaces, put together with those near them that look the same way, and places in media.
#pragma once

#include "math/vec.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// Which of the six faces of a cube a normal looks through: 2 · axis, and one more towards the negative side.
inline std::uint8_t faceOf(Vec3 n) {
    const Vec3 a{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    return static_cast<std::uint8_t>(2 * axis + (n[axis] < 0));
}

// In place of a face: within a medium.
inline constexpr std::uint8_t kInMedium = 6;

// Likewise for that normal of a surface which is on the side where `direction` comes from.
inline std::uint8_t faceAgainst(Vec3 direction, Vec3 n) { return faceOf(dot(n, direction) > 0 ? -n : n); }

// Binary trees, one for each face of normals and one for media, whose leaves are numbered.
class SpaceTree {
  public:
    struct Place {
        Vec3 p;
        std::uint8_t face = 0;
        std::uint32_t number = 0; // whatever it means to its owner
    };
    // A leaf holds at least about so many places, unless a whole face has fewer, and at most twice as many where they
    // can be halved at all. Puts the places of a leaf side by side; the same for the same places in the same order.
    SpaceTree(std::vector<Place>& places, std::size_t least);

    // Places outside of what is known belong to the leaves next to them. As many steps for all leaves of a face: how
    // deep one lies is not to be foreseen.
    std::uint32_t leaf(Vec3 p, std::uint8_t face) const {
        const std::array<float, 3> place{p.x, p.y, p.z};
        std::uint32_t node = face;
        for (std::uint32_t step = 0; step < depths_[face]; ++step) {
            const Node& n = nodes_[node];
            node = n.next + (place[n.axis] >= n.split);
        }
        return numbers_[node];
    }
    std::size_t leaves() const { return ends_.size(); }
    // Of a leaf, among the places that it was made for.
    std::span<const Place> members(const std::vector<Place>& places, std::size_t leaf) const {
        const std::size_t first = leaf > 0 ? ends_[leaf - 1] : 0;
        return {places.data() + first, ends_[leaf] - first};
    }
    std::size_t bytes() const {
        return nodes_.size() * (sizeof(Node) + sizeof(std::uint32_t)) + ends_.size() * sizeof(std::size_t);
    }

  private:
    // Inner: the children are `next` and `next` + 1, below and from `split` on. A leaf leads to itself, as no place is
    // from infinity on.
    struct Node {
        float split = kInfinity;
        std::uint32_t axis : 2 = 0, next : 30 = 0;
    };
    void divide(std::size_t node, std::span<Place>, std::size_t before, std::size_t least, std::vector<Place>& others);
    std::uint32_t depth(std::uint32_t node) const; // below it

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> numbers_;              // of the leaves, by nodes
    std::array<std::uint32_t, kInMedium + 1> depths_; // of the trees
    std::vector<std::size_t> ends_;                   // of the leaves' places
};

} // namespace abbe
