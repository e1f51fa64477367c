// Parameters of materials that may vary over a surface: a number, a curve or a texture.
#pragma once

#include "base/work.h"
#include "render/surface_hit.h"
#include "render/texture.h"
#include "schema/type.h"

namespace abbe {

// Marks a lookup of a texture. Around one lookup of a material or a light, whatever textures that one is made of.
class TextureWork : public WorkScope {
  public:
    TextureWork() : WorkScope(Work::textures) { ++workState.textureLookups; }
};

// From a hit to the query of a texture. The cone of the path meets the tangent plane in an ellipse; its half axes in uv
// follow from dp/du and dp/dv by least squares [Igehy1999, sec. 3.2; Pharr2023, eq. 10.5].
inline TextureQuery::TextureQuery(const SurfaceHit& h)
    : uv(h.uv), position(h.local), normal(h.localNormal), radius(h.footprint * h.localScale), hit(&h) {
    if (!(h.footprint > 0)) return;
    const float uu = dot(h.dpdu, h.dpdu), uw = dot(h.dpdu, h.dpdv), ww = dot(h.dpdv, h.dpdv);
    const float determinant = uu * ww - uw * uw;
    if (!(determinant > 1e-12f * uu * ww)) return; // no texture coordinates, or degenerate ones
    const float cosine = std::abs(dot(h.arrival, h.ng));
    Vec3 along = h.arrival - h.ng * dot(h.arrival, h.ng);
    const float sine = length(along);
    along = sine > 1e-4f ? along * (1 / sine) : h.shading.x;
    const Vec3 across = cross(h.ng, along);
    const Vec3 major = along * (h.footprint / std::max(cosine, 0.01f)), minor = across * h.footprint;
    const auto inUv = [&](Vec3 d) {
        const float a = dot(h.dpdu, d), b = dot(h.dpdv, d);
        return Vec2{(ww * a - uw * b) / determinant, (uu * b - uw * a) / determinant};
    };
    du = inUv(major);
    dv = inUv(minor);
}

// A reflectance, a tint: 0 … 1 where it comes from a texture.
class SpectrumInput {
  public:
    SpectrumInput(const schema::TexturedSpectrum& s, float byDefault)
        : curve_(s.curve), texture_(s.texture), byDefault_(byDefault) {}

    Spectrum at(const SurfaceHit& hit, const Wavelengths& lambda) const {
        if (texture_) {
            const TextureWork work;
            return texture_->spectrum(TextureQuery(hit), lambda);
        }
        return curve_ ? curve_->at(lambda) : Spectrum(byDefault_);
    }
    bool textured() const { return texture_ != nullptr; }
    // True if it was left out.
    bool absent() const { return !curve_ && !texture_; }

  private:
    const Curve* curve_;
    const Texture* texture_;
    float byDefault_;
};

// A roughness, a weight: the first channel of a texture, brought into the range of the parameter.
class NumberInput {
  public:
    NumberInput(const schema::TexturedNumber& n, float lower, float upper)
        : texture_(n.texture), value_(static_cast<float>(n.value)), lower_(lower), upper_(upper) {}

    float at(const SurfaceHit& hit) const {
        if (!texture_) return value_;
        const TextureWork work;
        return std::clamp(texture_->number(TextureQuery(hit)), lower_, upper_);
    }
    bool textured() const { return texture_ != nullptr; }
    // Whether it is this number everywhere.
    bool is(float value) const { return !texture_ && value_ == value; }

  private:
    const Texture* texture_;
    float value_, lower_, upper_;
};

} // namespace abbe
