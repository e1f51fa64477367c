// Which light to ask: discrete probabilities fixed for the whole render.
#pragma once

#include "render/light.h"

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace abbe {

struct PickedLight {
    const Light* light = nullptr;
    std::uint32_t part = 0; // of the light
    float probability = 0;
};

// Half of the picks go by power, half evenly: power alone would starve a dim lamp near the camera when a bright sky is
// outside the room. Refers to the scene's lights, which must outlive it.
class LightSampler {
  public:
    explicit LightSampler(const std::vector<std::unique_ptr<const Light>>&);

    bool empty() const { return lights_.empty(); }
    bool needsChoice() const { return lights_.size() > 1; }
    // Whether any light may have a reach.
    bool placed() const { return placed_; }
    // For light that arrives at a receiver. Requires !empty(); u in [0, 1).
    PickedLight pick(float u, const Receiver&) const noexcept;
    // Probability with which a part of `light`, one of the scene's, is picked there.
    float probability(const Light* light, std::uint32_t part, const Receiver&) const noexcept;
    // That of the light which samples this emission; 0 if none does.
    float probability(const MediumEmission* emission, const Receiver&) const noexcept;
    // The same for light that scatters somewhere on a piece of a ray.
    PickedLight pickAlong(float u, const Ray&, RayExtent) const noexcept;
    float probabilityAlong(const Light* light, std::uint32_t part, const Ray&, RayExtent) const noexcept;
    // Lights that rays which leave the scene meet.
    const std::vector<const Light*>& infinite() const { return infinite_; }

  private:
    std::vector<const Light*> lights_;
    std::vector<double> cumulative_; // of probability_, ends at 1
    std::vector<float> probability_;
    std::vector<const Light*> infinite_;
    std::unordered_map<const Light*, float> byLight_;
    std::unordered_map<const MediumEmission*, float> byEmission_;
    bool placed_ = false;
};

} // namespace abbe
