// A density of patches, billows or cells in all of space.
#pragma once

#include "math/vec.h"

#include <cstdint>

namespace abbe {

enum class NoiseKind : std::uint8_t {
    gradient, // soft patches and wisps
    billow,   // round heaps, from the magnitude of gradient noise
    cellular, // puffs around strewn points
};

struct NoisePattern {
    NoiseKind kind = NoiseKind::gradient;
    double scale = 1; // m, between the features of the first octave
    int octaves = 5;
    double lacunarity = 2; // frequency of an octave over that of the one before
    double gain = 0.5;     // its strength over that of the one before
    double warp = 0;       // how far places are displaced by noise, in units of `scale`
    double coverage = 0.5; // share of space where there is density
    double softness = 0.5; // how slowly density rises to 1: 1 only where it is thickest, 0 at once
    double contrast = 1;   // 0: density 1 everywhere; 1: the whole pattern
    std::uint32_t seed = 0;
};

// (1 - contrast) + contrast · s((noise - threshold) / softness), where s rises smoothly from 0 to 1 and the threshold
// is such that it does so in the share `coverage` of all space. Within minimum() … 1. A pure function of place and
// pattern, the same on every machine.
class NoiseField {
  public:
    explicit NoiseField(const NoisePattern&);

    // In metres. Finite for any finite place.
    float at(Vec3d p) const noexcept;
    float minimum() const { return minimum_; }
    // Over all space, estimated; 1 exactly where the field is.
    float mean() const { return mean_; }
    bool constant() const { return minimum_ == 1; }
    const NoisePattern& pattern() const { return pattern_; }

  private:
    float noise(Vec3d p) const noexcept; // sum of the octaves
    Vec3d warped(Vec3d p) const noexcept;
    float shaped(float noise) const noexcept;

    NoisePattern pattern_;
    float minimum_ = 1, mean_ = 1;
    float threshold_ = 0, ramp_ = 1; // in values of noise()
};

} // namespace abbe
