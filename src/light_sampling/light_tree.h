// Choosing one of many lights by how much each may give to a place: a tree over their bounds [ContyEstevez2018], of
// eight branches, which are weighed at once.
#pragma once

#include "base/parallel.h"
#include "light_sampling/glossy_receiver.h"
#include "render/light.h"
#include "render/ray.h"
#include "render/receiver.h"
#include "spectrum/spectrum.h"

#include <array>
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

    // Requires at least one light, all with power > 0 and finite boxes. `stop`: see light_tree::Builder.
    explicit LightTree(std::span<const LightBounds>, const StopFlag& stop = kNeverStop);

    // u in [0, 1), with more digits than the least probability. A surface whose lobes are told prefers lights that they
    // see; Requires a receiver with a normal, on the side of the view.
    // `factors`: of the root's eight branches, > 0: what they may give there is multiplied by them; null: 1.
    Pick pick(double u, const Receiver&, const ScatterView& = {}, const float* factors = nullptr) const noexcept;
    float probability(std::uint32_t light, const Receiver&, const ScatterView& = {},
                      const float* factors = nullptr) const noexcept;
    // For a piece of a ray on which the light is to scatter.
    Pick pick(double u, const Ray&, RayExtent) const noexcept;
    float probability(std::uint32_t light, const Ray&, RayExtent) const noexcept;

    // Estimate of the irradiance of a receiver by all lights, W/m² as the lights' power.
    float irradiance(const Receiver&, const float* factors = nullptr) const noexcept;
    // Of the root, and which of them a light hangs from.
    std::size_t branches() const;
    std::size_t branchOf(std::uint32_t light) const;
    // Number of nodes from the root to the deepest light.
    int depth() const { return depth_; }

  private:
    // Where a subtree or a light hangs.
    struct Branch {
        std::uint32_t node = 0;
        std::uint32_t slot = 0;
    };
    // Up to eight subtrees or lights, each bounded by a sphere and cones; those that are not there have no power.
    struct Node {
        Float8 x{}, y{}, z{}, radius2{}, power{};
        Float8 axisX{}, axisY{}, axisZ{}, cosNormals{}, sinNormals{}, cosEmission{};
        Int8 twoSided{};
        std::array<std::uint32_t, 8> next{}; // a node, or a light
        Branch parent;
        std::uint8_t lights = 0; // which of them are lights, as bits
        bool directed = false;   // whether any has cones narrower than everything
    };
    // Without the cones: a ray passes a light on both sides.
    struct Along {
        const Ray& ray;
        RayExtent extent;
    };
    static void assign(Node&, std::uint32_t slot, const LightBounds&);
    static Spectrum importance(const Node&, const Receiver&) noexcept;
    static Spectrum importance(const Node&, const GlossyReceiver&) noexcept;
    // `scatters` turns what a matte surface sees into what another one does.
    struct Seen {
        Spectrum x, y, z;     // unit, to the middle
        Spectrum cosine;      // of it, to the receiver's normal
        Spectrum sine, sine2; // of the ball's half angle
        Spectrum matte;
    };
    template <typename Scatters> static Spectrum weigh(const Node&, const Receiver&, Scatters&&) noexcept;
    static Spectrum importance(const Node&, const Along&) noexcept;
    // `factors` as pick() takes them, of the root.
    template <typename Place> static Spectrum importance(const Node&, const Place&, const float* factors) noexcept;
    // The probability of each branch.
    template <typename Place> static Spectrum shares(const Node&, const Place&, const float* factors) noexcept;
    template <typename Place> Pick pickAt(double u, const Place&, const float* factors = nullptr) const noexcept;
    template <typename Place>
    float probabilityAt(std::uint32_t light, const Place&, const float* factors = nullptr) const noexcept;

    std::vector<Node> nodes_;
    std::vector<Branch> places_; // of the lights
    int depth_ = 0;
};

} // namespace abbe
