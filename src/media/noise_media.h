// Mist, smoke and clouds made by noise, and how the language writes them.
#pragma once

#include "math/transform.h"
#include "media/medium_optics.h"
#include "render/kept_tables.h"
#include "volumes/brick_bounds.h"
#include "volumes/noise_field.h"

#include <memory>
#include <optional>
#include <variant>

namespace abbe {

// Where the noise is, and what thins it there. The box's own space, m.
struct NoiseBox {
    Vec3d lower, upper;
    double edge = 0;                                              // distance from the faces over which density rises
    double scaleHeight = std::numeric_limits<double>::infinity(); // over which density falls to 1/e
    int up = 1;                                                   // axis along which it falls, from the lower face
};

// A box of noise. Density is the field's, thinned by the box, and 0 outside. Bounds are sampled when it is made; they
// may be exceeded.
class NoiseVolume final : public OpticalMedium {
  public:
    // Requires an invertible transform and upper > lower.
    NoiseVolume(MediumOptics, const NoisePattern&, const NoiseBox&, const Transform& toRender,
                KeptTables* kept = nullptr);

    Bounds3 bounds() const override { return bounds_; }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;

    // In the box's space; what is outside the box is taken as on its faces.
    float density(Vec3d p) const noexcept;
    // Of the brick around such a place.
    FieldBounds boundsAt(Vec3d p) const;
    std::size_t brickCount() const { return bricks_->brickCount(); }

  private:
    class Sampled;
    Vec3d cellsPerMetre() const;

    NoiseField field_;
    NoiseBox box_;
    Vec3i brickCount_;
    std::shared_ptr<const BrickBounds> bricks_;
    Transform toBox_; // render space to that of the box
    Vec3d margin_;    // beyond the box, for which its bounds hold, too: a thirtieth of a cell
    Bounds3 bounds_;
    float thickest_; // greatest extinction, 1/m
};

// Noise without an end: what fills a shape, or all of space. Density is the field's, everywhere. The only bounds are
// those of the pattern, so that thin patterns cost lookups.
class NoiseMedium final : public OpticalMedium {
  public:
    // Requires an invertible transform, from the pattern's space to the world.
    NoiseMedium(MediumOptics, const NoisePattern&, const Transform& toWorld);
    // To be called before the first walk: where the origin of render space is in the world.
    void setOrigin(Vec3d origin) { origin_ = origin; }

    Bounds3 bounds() const override;
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;

  private:
    NoiseField field_;
    Transform toPattern_; // from the world
    Vec3d origin_;
};

// `medium noise`.
struct NoiseMediumParams : MediumParams, NoisePattern {
    schema::Choice kindWord{"gradient", std::nullopt};
    Transform transform;
};

// `volume noise`.
struct NoiseVolumeParams : NoiseMediumParams {
    std::optional<Vec3d> size, center, lowest, highest;
    double edge = 0;
    double scaleHeight = std::numeric_limits<double>::infinity();
};

NoisePattern patternOf(const NoiseMediumParams&);
// The box asked for, or why there is none.
std::variant<NoiseBox, std::string_view> boxOf(const NoiseVolumeParams&, bool zUp);

schema::TypeInfo noiseMediumType();
schema::TypeInfo noiseVolumeType();

} // namespace abbe
