// Parameters of materials that may vary over a surface: a number, a curve or a texture.
#pragma once

#include "render/texture_query.h"
#include "render/texture_work.h"
#include "schema/type.h"

namespace abbe {

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
        return std::clamp(texture_->value(TextureQuery(hit)).x, lower_, upper_);
    }
    bool textured() const { return texture_ != nullptr; }
    // Whether it is this number everywhere.
    bool is(float value) const { return !texture_ && value_ == value; }

  private:
    const Texture* texture_;
    float value_, lower_, upper_;
};

} // namespace abbe
