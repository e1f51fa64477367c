// The clear surface of something else: a smooth or rough dielectric interface of which only the reflection is followed.
#pragma once

#include "materials/ggx.h"
#include "render/bsdf.h"
#include "render/kept_tables.h"
#include "render/surface_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

namespace abbe {

// Share of the light from one direction that a gloss of one roughness reflects, by its cosine.
class GlossTable {
  public:
    GlossTable(double ior, float roughness);

    float at(float mu) const {
        const float x = std::sqrt(std::clamp(mu, 0.f, 1.f)) * (kNodes - 1);
        const int i = std::min(static_cast<int>(x), kNodes - 2);
        return node(i) + (node(i + 1) - node(i)) * (x - static_cast<float>(i));
    }
    // The mean of it over all directions, by cosine.
    float mean() const { return mean_; }

  private:
    static constexpr int kNodes = 129;
    float node(int i) const { return albedo_[static_cast<std::size_t>(i)]; }

    float mean_ = 0;
    std::array<float, kNodes> albedo_{}; // by √mu in equal steps
};

// Seen from outside; everything here needs wo.z > 0. The index is the same at all wavelengths: a thin layer does not
// disperse. Plain data; refers to tables of a GlossRange.
class Gloss {
  public:
    float ior() const { return ior_; }
    bool smooth() const { return ggx_.smooth(); } // reflects in one direction
    float alpha() const { return ggx_.alphaX(); }
    bool absent() const { return !below_; } // index 1: reflects nothing
    // Share of the light from one direction that it reflects, by its cosine; the rest is let through.
    float albedo(float mu) const;
    // The mean of it over all directions, by cosine.
    float meanAlbedo() const { return absent() ? 0 : lerp(below_->mean(), above_->mean()); }

    // Requires !smooth().
    struct Value {
        float fcos = 0, pdf = 0; // pdf: of sample()
    };
    Value eval(Vec3 wo, Vec3 wi) const;
    std::optional<Vec3> sample(Vec3 wo, Vec2 u) const;
    // fcos / pdf of a sample, without the division.
    float weight(Vec3 wo, Vec3 wi) const;

  private:
    friend class GlossRange;
    friend class GlossTable;
    Gloss(float ior, float roughness) : ior_(ior), ggx_(Ggx::fromRoughness(roughness, 0)) {}
    float lerp(float below, float above) const { return below + (above - below) * between_; }
    // What one bounce loses between microfacets is given back, as to a whole interface.
    float lossless(float mu) const;
    float reflectance(Vec3 wo, Vec3 wi) const;

    float ior_;
    Ggx ggx_;
    const GlossTable* below_ = nullptr; // of the next roughness below and above; null: absent
    const GlossTable* above_ = nullptr;
    float between_ = 0;
};

// A gloss whose roughness may vary over a surface: with a texture, it is tabulated at some and interpolated between
// them. Immutable, thread-safe.
class GlossRange {
  public:
    // Index relative to what is around it, > 0; roughness 0 … 1. Tables take a while.
    GlossRange(double ior, const schema::TexturedNumber& roughness, KeptTables* kept = nullptr);

    Gloss at(const SurfaceHit& hit) const { return of(roughness_.at(hit)); }
    bool textured() const { return roughness_.textured(); }

  private:
    static constexpr int kRoughnesses = 25; // 0 … 1 in equal steps
    Gloss of(float roughness) const;

    float ior_;
    NumberInput roughness_;
    std::shared_ptr<const std::vector<GlossTable>> tables_; // null if the index is 1
};

} // namespace abbe
