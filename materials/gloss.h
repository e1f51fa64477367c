// The clear surface of something else: a smooth or rough dielectric interface of which only the reflection is followed.
#pragma once

#include "materials/ggx.h"
#include "render/bsdf.h"

#include <array>
#include <optional>

namespace abbe {

// Seen from outside; everything here needs wo.z > 0. The index is the same at all wavelengths: a thin layer does not
// disperse. Immutable, thread-safe.
class Gloss {
  public:
    // Index relative to what is around it, > 0; roughness 0 … 1.
    Gloss(double ior, float roughness);

    float ior() const { return ior_; }
    bool smooth() const { return ggx_.smooth(); } // reflects in one direction
    bool absent() const { return absent_; }       // index 1: reflects nothing
    // Share of the light from one direction that it reflects, by its cosine; the rest is let through.
    float albedo(float mu) const;
    // The mean of it over all directions, by cosine.
    float meanAlbedo() const { return meanAlbedo_; }

    // Requires !smooth().
    struct Value {
        float fcos = 0, pdf = 0; // pdf: of sample()
    };
    Value eval(Vec3 wo, Vec3 wi) const;
    std::optional<Vec3> sample(Vec3 wo, Vec2 u) const;
    // fcos / pdf of a sample, without the division.
    float weight(Vec3 wo, Vec3 wi) const;

  private:
    static constexpr int kNodes = 129;
    // What one bounce loses between microfacets is given back, as to a whole interface.
    float lossless(float mu) const;
    float reflectance(Vec3 wo, Vec3 wi) const;

    float ior_;
    Ggx ggx_;
    bool absent_;
    float meanAlbedo_ = 0;
    std::array<float, kNodes> albedo_{}; // rough: by √mu in equal steps
};

} // namespace abbe
