// Lights that move: what they are at rest, seen from where the world is then.
#pragma once

#include "lights/area_light.h"
#include "lights/light_motion.h"

namespace abbe {

// A light without surface, which may have an extent, or infinitely far away: only its rotation matters then.
class MovingLight final : public Light {
  public:
    MovingLight(std::unique_ptr<Light> atRest, LightMotion motion)
        : atRest_(std::move(atRest)), motion_(std::move(motion)) {}

    void commit(const Bounds3& bounds) override { atRest_->commit(bounds); }
    double power() const override { return atRest_->power(); }
    double visiblePower() const override { return atRest_->visiblePower(); }
    double irradiance() const override { return atRest_->irradiance(); }
    std::uint32_t parts() const override { return atRest_->parts(); }
    std::optional<LightBounds> bounds(std::uint32_t part) const override;
    const Curve* powerShape() const override { return atRest_->powerShape(); }
    bool infinite() const override { return atRest_->infinite(); }
    bool bodiless() const override { return atRest_->bodiless(); }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float time) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths&, float time) const noexcept override;
    float pdfEscaped(const Receiver&, Vec3 w, float time) const noexcept override;
    float pdfAtPoint(const Receiver&, std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;
    std::optional<LightReach> reach(const Ray&, float tMax) const noexcept override;

    // Intensity stays when the scale changes, or the radiance of what has an extent.
    LightPaths paths() const override { return atRest_->paths(); }
    std::optional<LightOrigin> sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths&,
                                            float time) const noexcept override;
    LightOrigin originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept override;
    Vec3 sampleDirection(const LightOrigin&, Vec2 u) const noexcept override;
    float pdfDirection(const LightOrigin&, Vec3 w) const noexcept override;
    Spectrum leaving(const LightOrigin&, Vec3 w, const Wavelengths&) const noexcept override;
    std::optional<LightSample> sampleDistant(Vec2 u, const Wavelengths&, float time) const noexcept override;
    float pdfDistant(Vec3 w, float time) const noexcept override;

  private:
    std::unique_ptr<Light> atRest_;
    LightMotion motion_;
};

// A shape that emits; rays meet it as an instance with the same motion. Radiance stays when the scale changes.
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

// As the context says: the light itself, or one that moves. Null stays null.
std::unique_ptr<Light> inMotion(std::unique_ptr<Light>, const LightContext&);

} // namespace abbe
