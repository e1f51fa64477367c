// What patterns are made of: spectra and other textures.
#pragma once

#include "base/diagnostic.h"
#include "render/texture.h"
#include "schema/type.h"

namespace abbe {

// Refers to its curve or texture. One that was left out has the same value everywhere.
class TexturePart {
  public:
    TexturePart(const schema::TexturedSpectrum& part, float byDefault)
        : curve_(part.curve), texture_(part.texture),
          number_(curve_ ? static_cast<float>(curve_->at(kMiddle)) : byDefault) {}

    Spectrum spectrum(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
        if (texture_) return texture_->spectrum(query, lambda);
        return curve_ ? curve_->at(lambda) : Spectrum(number_);
    }
    Spectrum lightFactor(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
        if (texture_) return texture_->lightFactor(query, lambda);
        return curve_ ? curve_->at(lambda) : Spectrum(number_);
    }
    Vec3 value(const TextureQuery& query) const noexcept {
        return texture_ ? texture_->value(query) : Vec3(number_, number_, number_);
    }
    float number(const TextureQuery& query) const noexcept { return texture_ ? texture_->number(query) : number_; }
    TextureJet jet(const TexturePoint& point, int channels) const noexcept;
    bool needsUv() const { return texture_ && texture_->needsUv(); }
    bool covers(Vec2 uv) const noexcept { return !texture_ || texture_->covers(uv); }
    const RgbSpace* rgbSpace() const { return texture_ ? texture_->rgbSpace() : nullptr; }
    // Warns at `user` if this is a coloured spectrum and not asked for as one.
    void prepare(TextureUse, Span user, Diagnostics&) const;

  private:
    static constexpr double kMiddle = 550; // nm: where a coloured spectrum is taken for a number
    const Curve* curve_;
    const Texture* texture_;
    float number_;
};

// Half the width of the box, along one axis, that weighs like an ellipse with these half axes: equal variance.
inline double boxHalfWidth(float major, float minor) {
    return std::sqrt(0.75 * (square(static_cast<double>(major)) + square(static_cast<double>(minor))));
}

// The same for a coordinate in space: the footprint is a disk across the normal.
inline double boxHalfWidth(const TextureQuery& q, float normalAlongAxis) {
    return boxHalfWidth(q.radius * safeSqrt(1 - normalAlongAxis * normalAlongAxis), 0);
}

} // namespace abbe
