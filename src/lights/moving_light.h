// Lights that move: what they are at rest, seen from where the world is then.
#pragma once

#include "lights/area_light.h"
#include "lights/light_context.h"

namespace abbe {

// A light without surface, which may have an extent.
class MovingPlacedLight final : public PlacedLight {
  public:
    MovingPlacedLight(std::unique_ptr<PlacedLight> atRest, LightMotion motion)
        : atRest_(std::move(atRest)), motion_(std::move(motion)) {}

    void commit(const Bounds3& bounds) override { atRest_->commit(bounds); }
    LightOutput output() const override { return atRest_->output(); }
    std::uint32_t parts() const override { return atRest_->parts(); }
    std::optional<LightBounds> bounds(std::uint32_t part) const override;
    bool hasNoSurface() const override { return atRest_->hasNoSurface(); }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float time) const noexcept override;
    float pdfAtPoint(const Receiver&, std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;

    // Intensity stays when the scale changes, or the radiance of what has an extent.
    std::optional<LightOrigin> sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths&,
                                            float time) const noexcept override;
    LightOrigin originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override;
    float pdfDirection(const LightOrigin&, Vec3 w) const noexcept override;
    Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths&) const noexcept override;

  private:
    std::unique_ptr<PlacedLight> atRest_;
    LightMotion motion_;
};

// One infinitely far away: only its rotation matters.
class MovingDistantLight final : public DistantLight {
  public:
    MovingDistantLight(std::unique_ptr<DistantLight> atRest, LightMotion motion)
        : atRest_(std::move(atRest)), motion_(std::move(motion)) {}

    void commit(const Bounds3& bounds) override { atRest_->commit(bounds); }
    LightOutput output() const override { return atRest_->output(); }
    bool hasExtent() const override { return atRest_->hasExtent(); }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float time) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float time) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float time) const noexcept override;
    std::optional<LightSample> sampleDistant(Vec2 u, const Wavelengths&, float time) const noexcept override;
    float pdfDistant(Vec3 w, float time) const noexcept override;

  private:
    std::unique_ptr<DistantLight> atRest_;
    LightMotion motion_;
};

// A shape that emits; rays hit it as an instance with the same motion. Radiance stays when the scale changes.
class MovingAreaLight final : public AreaLight {
  public:
    // `atRest`: as AreaLight has it, at rest.
    MovingAreaLight(const Shape& atRest, ScaledCurve radiance, bool twoSided, LightMotion motion,
                    std::unique_ptr<const LightTexture> texture = nullptr, const EmissionVeil* veil = nullptr)
        : AreaLight(atRest, radiance, twoSided, std::move(texture), veil), motion_(std::move(motion)) {}

    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float time) const noexcept override;
    float pdfSolidAngle(const Receiver&, const SurfaceHit& hit, float time) const noexcept override;
    float pdfAtPoint(const Receiver&, std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;
    std::optional<LightBounds> bounds(std::uint32_t part) const override;
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;
    std::optional<LightOrigin> sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths&,
                                            float time) const noexcept override;
    LightOrigin originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;

  private:
    LightMotion motion_;
};

// As the context says: the light itself, or one that moves. Null stays null. Placed lights must have no surface.
std::unique_ptr<Light> inMotion(std::unique_ptr<PlacedLight>, const LightContext&);
std::unique_ptr<Light> inMotion(std::unique_ptr<DistantLight>, const LightContext&);

} // namespace abbe
