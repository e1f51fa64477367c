// Flames: what a volume emits, found along rays and sampled as a light.
#pragma once

#include "media/emission_bricks.h"
#include "render/light.h"
#include "render/medium.h"
#include "volumes/brick_walk.h"

namespace abbe {

// What a ray gathers in a volume that emits.
class GridEmission final : public MediumEmission {
  public:
    // The fields must outlive it.
    explicit GridEmission(const EmissionFields&);

    bool dark() const { return !sampler_; } // nothing emits; it must not be asked for anything else
    EmissionWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;
    float pdfSolidAngle(Vec3 from, Vec3 p) const noexcept override;

    // For its light. A point, render space; u in [0, 1)².
    Vec3 samplePoint(Vec2 u) const noexcept;
    float edge() const { return edge_; } // ℓ of MediumEmission, the mean edge of a brick in render space
    Spectrum emitted(Vec3 p, float time, const Wavelengths&) const noexcept; // W·m⁻³·sr⁻¹·nm⁻¹
    double power() const { return power_; } // W, of which it may absorb some itself; about right
    Vec3 centre() const { return centre_; }
    // Of all points that it samples. Requires !dark().
    Bounds3 bounds() const;

  private:
    double estimatePower(const GlowTable&) const;

    EmissionFields fields_;
    BrickBounds bricks_;
    std::optional<BrickSampler> sampler_;
    double perVoxel_ = 0; // voxels in a unit of volume of render space
    float edge_ = 0;
    double power_ = 0;
    Vec3 centre_;
};

// A volume that emits, as one of the scene's lights.
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
