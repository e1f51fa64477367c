// Which light next-event estimation samples at a place.
#pragma once

#include "light_sampling/light_arrival.h"
#include "light_sampling/light_tree.h"
#include "render/integrator.h"
#include "render/light.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace abbe {

struct PickedLight {
    const Light* light = nullptr;
    std::uint32_t part = 0; // of the light
    float probability = 0;
};

// Lights that have bounds are the leaves of a tree, part by part; the others, far away, are chosen half by what they
// give and half evenly, and where they are few as far as a receiver can have them in sight. Between the two an estimate
// of the irradiance by each decides, but neither gets less than kLeastShare of the picks: a tree's estimate knows
// nothing of walls, and inside its bounds next to nothing at all. Dark lights are never picked. Refers to the scene's
// lights, which must outlive it.
//
// Where scattering finds all light beside it, even skies are left to it as long as there is anything else to pick: a
// matte surface scatters just as its cosine would choose among their directions, so that samples of them would bring
// next to nothing, and picks that miss the sun much noise (docs/decisions/038-even-skies.md).
// Once `stop` is set while it is made it is good for nothing.
class LightSampler {
  public:
    static constexpr float kLeastShare = 0.1f;

    // `leavesEven`: scattering finds all light that it can hit, with the weight 1 where nothing is picked.
    explicit LightSampler(const std::vector<std::unique_ptr<const Light>>&,
                          Technique::LightChoice = Technique::LightChoice::tree, const StopFlag& stop = kNeverStop,
                          bool leavesEven = false);

    bool empty() const { return lights_.empty(); }
    bool needsChoice() const { return lights_.size() > 1; }
    // Whether any light may have a reach.
    bool placed() const { return placed_; }
    // Whether a ScatterView makes a difference.
    bool usesLobes() const { return near_ > 1; }
    // For light that arrives at a receiver and is scattered. Requires !empty(); u in [0, 1).
    // What is known of walls may be left out, but for all that is asked of one place.
    PickedLight pick(float u, const Receiver&, const ScatterView& = {}, const LightArrival* = nullptr) const noexcept;
    // Probability with which a part of `light`, one of the scene's, is picked there.
    float probability(const Light* light, std::uint32_t part, const Receiver&, const ScatterView& = {},
                      const LightArrival* = nullptr) const noexcept;
    // That of the light which samples this emission; 0 if none does.
    float probability(const MediumEmission* emission, const Receiver&, const ScatterView& = {},
                      const LightArrival* = nullptr) const noexcept;
    // In LightArrival::Factors; nothing for what is never picked.
    std::optional<std::size_t> groupOf(const Light*, std::uint32_t part) const noexcept;
    // Whether there is more than one.
    bool hasGroups() const;
    // The same for light that scatters somewhere on a piece of a ray: lights far away only where there are no others.
    PickedLight pickAlong(float u, const Ray&, RayExtent) const noexcept;
    float probabilityAlong(const Light* light, std::uint32_t part, const Ray&, RayExtent) const noexcept;
    // Lights that rays which leave the scene hit.
    const std::vector<const DistantLight*>& infinite() const { return infinite_; }

  private:
    struct Source {
        const Light* light = nullptr;
        std::uint32_t part = 0;
    };
    static constexpr std::uint32_t kNone = 0xffffffffu;

    struct Run {
        std::uint32_t first = 0, count = 0;
    };

    void weighFar(const std::vector<double>& amounts);
    void number(const std::vector<std::unique_ptr<const Light>>&);
    std::uint32_t find(const Light*, std::uint32_t part) const noexcept;
    float nearShare(const Receiver&, const float* arrives) const noexcept;
    float farIrradiance(const Receiver&, const float* arrives) const noexcept;
    // How much of a light far away, 0 … 1; `arrives`: as LightArrival::at().
    float inSight(std::size_t far, const Receiver&, const float* arrives) const noexcept;
    static constexpr std::size_t kMostWeighed = 8; // of far lights: those that a receiver is asked about
    using FarShares = std::array<float, kMostWeighed>;
    FarShares farShares(const Receiver&, const float* arrives) const noexcept; // Requires farInSight_
    PickedLight pickFar(double u, float share, const Receiver&, const float* arrives) const noexcept;
    PickedLight picked(std::uint32_t i, float probability) const {
        return {lights_[i].light, lights_[i].part, probability};
    }
    float probabilityOf(std::uint32_t i, const Receiver&, const ScatterView&, const float* arrives) const noexcept;

    std::vector<Source> lights_; // those in the tree, in its order, then those far away
    std::uint32_t near_ = 0;     // how many are in the tree
    std::optional<LightTree> tree_;
    float farIrradiance_ = 0;           // by all far lights, W/m²
    std::vector<double> farCumulative_; // of farProbability_, ends at 1
    std::vector<float> farProbability_; // among them
    std::vector<float> farAmount_;
    bool farInSight_ = false; // whether a receiver has a say
    std::vector<const DistantLight*> infinite_;
    std::unordered_map<const Light*, Run> offsets_; // of their parts in places_
    std::vector<std::uint32_t> places_;             // in lights_, or kNone: dark
    std::unordered_map<const MediumEmission*, const Light*> emitters_;
    bool placed_ = false;
};

} // namespace abbe
