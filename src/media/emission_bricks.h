// Where a volume emits, and how brightly: bricks of its grids, and sampling by them.
#pragma once

#include "math/bounds.h"
#include "media/glow.h"
#include "media/grid_field.h"
#include "volumes/brick_bounds.h"

#include <vector>

namespace abbe {

// value = offset + scale · grid.
struct ScaledField {
    const GridField<float>* field = nullptr;
    float scale = 1, offset = 0;
};

// The fields that decide what a volume emits.
struct EmissionFields {
    ScaledField amount;      // offset 0
    ScaledField temperature; // K; none unless the glow is thermal
    Glow glow;
    const GridColor* color = nullptr;   // none unless the glow is by albedo
    const GridMotion* motion = nullptr; // none: all stands still
};

// What a volume emits. Along a line of render space at one time, for one thread.
class EmissionAlong {
  public:
    EmissionAlong(const EmissionFields& f, Vec3d origin, Vec3d direction, float time)
        : fields_(&f), amount_(*f.amount.field, origin, direction), color_(f.color, origin, direction),
          motion_(f.motion, origin, direction, time) {
        if (f.temperature.field) temperature_.emplace(*f.temperature.field, origin, direction);
    }

    struct State {
        float amount = 0, kelvin = 0;
    };
    State state(float t) noexcept { return motion_.moves() ? stateAt(t, motion_.shift(t)) : stateAt(t); }

    // W·m⁻³·sr⁻¹·nm⁻¹
    Spectrum emitted(float t, const Wavelengths& lambda) noexcept {
        return motion_.moves() ? emittedAt(lambda, t, motion_.shift(t)) : emittedAt(lambda, t);
    }

  private:
    // `place`: a distance along the line, perhaps with a shift beside it.
    template <typename... Place> State stateAt(Place... place) noexcept {
        const EmissionFields& f = *fields_;
        const float amount = f.amount.scale * amount_.at(place...);
        if (!(amount > 0) || !temperature_) return {amount, 0};
        return {amount, f.temperature.offset + f.temperature.scale * temperature_->at(place...)};
    }
    template <typename... Place> Spectrum emittedAt(const Wavelengths& lambda, Place... place) noexcept {
        const State s = stateAt(place...);
        if (!(s.amount > 0)) return Spectrum(0.f);
        const EmissionFields& f = *fields_;
        return (f.color ? f.glow.at(s.kelvin, lambda, color_.at(place..., lambda)) : f.glow.at(s.kelvin, lambda)) *
               s.amount;
    }

    const EmissionFields* fields_;
    FieldAlong<float> amount_;
    std::optional<FieldAlong<float>> temperature_;
    ColorAlong color_;
    MotionAlong motion_;
};

// Bricks of the amount's grid in which there may be emission at some time, with `mean` about proportional to what is
// seen of it: never 0 where anything emits. Runs in parallel, the same on any number of threads.
BrickBounds emissionBricks(const EmissionFields&, const GlowTable&);
// The highest temperature there is, K; 0 without temperatures.
double hottest(const EmissionFields&);

// Draws points of bricks with a density in proportion to their `mean`.
class BrickSampler {
  public:
    // Refers to the bricks. Requires some.
    explicit BrickSampler(const BrickBounds&);

    // Index space; u in [0, 1)².
    Vec3d sample(Vec2 u) const noexcept;
    // Of such a point, per voxel; 0 outside of the bricks.
    double density(Vec3 p) const noexcept { return static_cast<double>(bricks_->at(p).mean) * perMean_; }
    // Mean of the points.
    Vec3d centre() const { return centre_; }
    // Holds all points.
    Bounds3d bounds() const;

  private:
    struct Cell {
        Vec3i corner; // voxel
        int size;     // voxels
    };
    const BrickBounds* bricks_;
    std::vector<Cell> cells_;
    std::vector<double> cumulative_; // of the cells' probability, ends at 1
    double perMean_ = 0;
    Vec3d centre_;
};

} // namespace abbe
