// A shape that emits the same radiance in all directions of its outer side, but for what a veil takes: from all its
// points, or with a texture.
#pragma once

#include "lights/amount.h"
#include "lights/light_texture.h"
#include "render/light.h"
#include "render/material.h"
#include "render/shape.h"

#include <memory>

namespace abbe {

class AreaLight : public SurfaceLight {
  public:
    // The shape is in render space; shape and curve outlive the light. `radiance` is that where the texture is 1; the
    // texture is one over the same shape and curve. The veil outlives the light; null: none.
    AreaLight(const Shape&, ScaledCurve radiance, bool twoSided, std::unique_ptr<const LightTexture> = nullptr,
              const EmissionVeil* veil = nullptr);

    // Infinite planes cannot be sampled: 0, so that they are never chosen.
    LightOutput output() const override {
        return {.power = power_, .visiblePower = visiblePower_, .spectrum = veiled_ ? &*veiled_ : unveiled()};
    }
    std::uint32_t parts() const override { return sampling_->emitterParts(); }
    std::optional<LightBounds> bounds(std::uint32_t part) const override;
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float) const noexcept override;
    // Nothing for shapes without an end.
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;
    Spectrum emitted(const SurfaceHit& hit, Vec3 w, const Wavelengths&) const noexcept override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit& hit, float) const noexcept override;
    float pdfAtPoint(const Receiver&, std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;

    std::optional<LightOrigin> sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths&,
                                            float time) const noexcept override;
    LightOrigin originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;
    // In proportion to the cosine, on the sides that emit.
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override;
    float pdfDirection(const LightOrigin&, Vec3 w) const noexcept override;
    Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths&) const noexcept override;

  protected:
    Vec3 centre() const { return centre_; } // of its bounds
    // A point of a part, and what dims the light there. As Shape::sample, at rest.
    std::optional<ShapeSample> point(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                     Spectrum& factor) const noexcept;
    // The light from a point of the shape; nothing if none arrives.
    std::optional<LightSample> arriving(const ShapeSample&, Vec3 from, const Wavelengths&,
                                        const Spectrum& factor) const noexcept;

  private:
    bool emits(Vec3 ng, Vec3 w) const noexcept { return twoSided_ ? dot(ng, w) != 0 : dot(ng, w) > 0; }
    LightOrigin originOf(Vec3 p, Vec3 n, float pdf, float time) const noexcept;
    // Light that leaves at this cosine, of either sign, where the texture is 1.
    Spectrum radiance(float cosine, const Wavelengths&) const noexcept;
    // Shape of the spectrum in the mean over the surface.
    const Curve* unveiled() const { return texture_ ? &texture_->spectrum() : radiance_.curve; }
    const Shape& shape_;
    SamplingOf sampling_;
    Vec3 centre_;
    ScaledCurve radiance_;
    std::unique_ptr<const LightTexture> texture_; // or null
    const EmissionVeil* veil_;                    // or null
    std::optional<SampledCurve> veiled_;          // unveiled(), and what the veil lets through of it
    double power_, visiblePower_;
    bool twoSided_;
};

struct LightContext;
struct AreaLightParams;

// A light over a shape that the caller has built. Null after an error.
std::unique_ptr<SurfaceLight> makeAreaLight(const AreaLightParams&, const Shape&, const LightContext&, Diagnostics&);

} // namespace abbe
