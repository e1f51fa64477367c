// A texture with other texture coordinates than the shape's: scaled, turned, moved.
#pragma once

#include "textures/texture_part.h"

namespace abbe {

struct PlacedTextureParams {
    schema::TexturedSpectrum map = {};
    Vec2d scale{1, 1}; // repeats across one unit of the texture coordinates
    double rotate = 0; // rad
    Vec2d offset{0, 0};
};

// Looks the map up at R(rotate) · scale · uv + offset. Of the map, v runs upwards as everywhere. The mean over the
// footprint is that over its image, which is an ellipse again.
class PlacedTexture final : public Texture {
  public:
    explicit PlacedTexture(const PlacedTextureParams&);

    int channels() const override { return 3; }
    bool needsUv() const override { return map_.needsUv(); }
    const RgbSpace* rgbSpace() const override { return map_.rgbSpace(); }
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery& q) const noexcept override { return map_.value(placed(q)); }
    float number(const TextureQuery& q) const noexcept override { return map_.number(placed(q)); }
    Spectrum spectrum(const TextureQuery& q, const Wavelengths& lambda) const noexcept override {
        return map_.spectrum(placed(q), lambda);
    }
    Spectrum lightFactor(const TextureQuery& q, const Wavelengths& lambda) const noexcept override {
        return map_.lightFactor(placed(q), lambda);
    }
    bool covers(Vec2 uv) const noexcept override { return map_.covers(placed(uv)); }

  private:
    Vec2 turned(Vec2 v) const {
        return {static_cast<float>(a_.x * v.x + a_.y * v.y), static_cast<float>(b_.x * v.x + b_.y * v.y)};
    }
    Vec2 placed(Vec2 uv) const {
        return {static_cast<float>(a_.x * uv.x + a_.y * uv.y + offset_.x),
                static_cast<float>(b_.x * uv.x + b_.y * uv.y + offset_.y)};
    }
    TextureQuery placed(TextureQuery) const;

    TexturePart map_;
    Vec2d a_, b_; // rows of the matrix
    Vec2d offset_;
};

schema::TypeInfo placedTextureType();

} // namespace abbe
