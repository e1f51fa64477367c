// A volume that shines, as one of the scene's lights.
#pragma once

#include "media/grid_emission.h"
#include "render/light.h"

namespace abbe {

class VolumeLight final : public Light {
  public:
    // Must outlive it. Requires that it is not dark.
    explicit VolumeLight(const GridEmission& emission) : emission_(emission) {}

    // The visible power is a flame's: most of what it gives off is red.
    LightOutput output() const override {
        return {.power = emission_.power(), .visiblePower = 0.15 * emission_.power()};
    }
    std::optional<LightBounds> bounds(std::uint32_t) const override {
        return LightBounds{.box = emission_.bounds(), .power = static_cast<float>(visiblePower())};
    }
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override {
        return LightReach{emission_.centre(), 0, tMax};
    }
    const MediumEmission* emission() const override { return &emission_; }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float time) const noexcept override;

  private:
    const GridEmission& emission_;
};

} // namespace abbe
