// The fields that decide what a volume gives off.
#pragma once

#include "media/glow.h"
#include "media/grid_color.h"
#include "media/grid_motion.h"

namespace abbe {

// value = offset + scale · grid.
struct ScaledField {
    const GridField<float>* field = nullptr;
    float scale = 1, offset = 0;
};

struct EmissionFields {
    ScaledField amount;      // offset 0
    ScaledField temperature; // K; none unless the glow is thermal
    Glow glow;
    const GridColor* color = nullptr;   // none unless the glow is by albedo
    const GridMotion* motion = nullptr; // none: all stands still
};

// Along a line of render space at one time, for one thread.
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

} // namespace abbe
