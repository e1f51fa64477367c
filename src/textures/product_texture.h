// Two textures multiplied.
#pragma once

#include "textures/texture_part.h"

namespace abbe {

struct ProductTextureParams {
    schema::TexturedSpectrum first = {}, second = {};
};

// The product of the means over the footprint.
class ProductTexture final : public Texture {
  public:
    explicit ProductTexture(const ProductTextureParams& p) : first_(p.first, 1), second_(p.second, 1) {}

    int channels() const override { return 3; }
    bool needsUv() const override { return first_.needsUv() || second_.needsUv(); }
    const RgbSpace* rgbSpace() const override { return first_.rgbSpace() ? first_.rgbSpace() : second_.rgbSpace(); }
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery& q) const noexcept override { return multiply(first_.value(q), second_.value(q)); }
    float number(const TextureQuery& q) const noexcept override { return first_.number(q) * second_.number(q); }
    Spectrum spectrum(const TextureQuery& q, const Wavelengths& lambda) const noexcept override {
        return first_.spectrum(q, lambda) * second_.spectrum(q, lambda);
    }
    Spectrum lightFactor(const TextureQuery& q, const Wavelengths& lambda) const noexcept override {
        return first_.lightFactor(q, lambda) * second_.lightFactor(q, lambda);
    }

  private:
    TexturePart first_, second_;
};

schema::TypeInfo productTextureType();

} // namespace abbe
