// Scattering at a point inside a medium: how much goes where.
#pragma once

namespace abbe {

// Rotationally symmetric about the direction in which light travels, the same at every wavelength. Immutable,
// thread-safe. `cosine` is that of the angle between the directions of travel before and after: 1 goes straight on.
class PhaseFunction {
  public:
    virtual ~PhaseFunction() = default;
    // Density over the sphere, 1/sr; its integral is 1.
    virtual float value(float cosine) const noexcept = 0;
    // A cosine whose direction, with an azimuth drawn evenly, has exactly the density value(). u in [0, 1).
    virtual float sampleCosine(float u) const noexcept = 0;
};

} // namespace abbe
