// Choosing one of many lights by how much each may give to a place: a binary tree over their bounds [ContyEstevez2018].
#pragma once

#include "render/light_bounds.h"
#include "render/ray.h"
#include "render/receiver.h"

#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// Immutable, thread-safe. Nothing that may give light to a place has probability 0 there. Probabilities do not change
// when the scene is scaled.
class LightTree {
  public:
    struct Pick {
        std::uint32_t light = 0; // position in the span given to the constructor
        float probability = 0;
    };

    // Requires at least one light, all with power > 0 and finite boxes.
    explicit LightTree(std::span<const LightBounds>);

    // u in [0, 1), with more digits than the least probability.
    Pick pick(double u, const Receiver&) const noexcept;
    float probability(std::uint32_t light, const Receiver&) const noexcept;
    // For a piece of a ray on which the light is to scatter.
    Pick pick(double u, const Ray&, RayExtent) const noexcept;
    float probability(std::uint32_t light, const Ray&, RayExtent) const noexcept;

    // Estimate of the irradiance of a receiver by all lights, W/m² as the lights' power.
    float irradiance(const Receiver&) const noexcept;
    // Number of nodes from the root to the deepest light, less one.
    int depth() const { return depth_; }

  private:
    // A subtree, bounded by a sphere and cones. Its children are neighbours.
    struct alignas(64) Node {
        Vec3 centre;
        float radius2 = 0;
        Vec3 axis;
        float power = 0;
        float cosNormals = -1, sinNormals = 0;
        float cosEmission = 0;
        bool twoSided = false, leaf = false;
        std::uint32_t next = 0; // the first child, or the light
    };
    static_assert(sizeof(Node) == 64);
    static void assign(Node&, const LightBounds&);
    static float importance(const Node&, const Receiver&) noexcept;
    // Without the cones: a ray passes a light on both sides.
    struct Along {
        const Ray& ray;
        RayExtent extent;
    };
    static float importance(const Node&, const Along&) noexcept;
    template <typename Place> float firstShare(const Node& parent, const Place&) const noexcept;
    template <typename Place> Pick pickAt(double u, const Place&) const noexcept;
    template <typename Place> float probabilityAt(std::uint32_t light, const Place&) const noexcept;

    std::vector<Node> nodes_;
    std::vector<std::uint64_t> trails_; // per light: the turns from the root, lowest bit first
    int depth_ = 0;
};

} // namespace abbe
