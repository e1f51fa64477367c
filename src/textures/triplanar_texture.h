// A texture over uv for shapes without texture coordinates: projected along three axes.
#pragma once

#include "textures/texture_part.h"

#include <memory>

namespace abbe {

struct TriplanarTextureParams {
    schema::TexturedSpectrum map = {};
    double scale = 1; // m
    double sharpness = 4;
};

// In the shape's own space: seen along x it lies over z and y, along y over x and z, along z over x and y, all three
// upright for y up. Weights are |n|^sharpness of the normal's components.
class TriplanarTexture final : public Texture {
  public:
    explicit TriplanarTexture(const TriplanarTextureParams&);

    int channels() const override { return 3; }
    bool needsUv() const override { return false; }
    const RgbSpace* rgbSpace() const override { return map_.rgbSpace(); }
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    // Without a normal: the three means. prepare() refuses heights.
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery&) const noexcept override;
    Spectrum spectrum(const TextureQuery&, const Wavelengths&) const noexcept override;
    Spectrum lightFactor(const TextureQuery&, const Wavelengths&) const noexcept override;

  private:
    template <typename Add> void project(const TextureQuery&, Add) const;

    TexturePart map_;
    float frequency_, sharpness_; // 1/m
};

schema::TypeInfo triplanarTextureType();

} // namespace abbe
