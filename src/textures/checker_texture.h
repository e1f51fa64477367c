// Checkers over texture coordinates or in space.
#pragma once

#include "textures/texture_part.h"

#include <memory>

namespace abbe {

struct CheckerTextureParams {
    schema::TexturedSpectrum even = {}, odd = {};
    schema::Quantity scale{
        8, schema::Dimension::none, {}, {}}; // checks across one unit of uv, or the edge of a cube, m
};

// Averaged over the footprint as over a box along the axes of the pattern, in closed form: what is left of it far away
// is the mean of its two parts, without an alias. As numbers parts are the first channel or the value of the spectrum.
class CheckerTexture final : public Texture {
  public:
    explicit CheckerTexture(const CheckerTextureParams&);

    int channels() const override { return 3; }
    bool needsUv() const override { return !solid_ || even_.needsUv() || odd_.needsUv(); }
    const RgbSpace* rgbSpace() const override { return even_.rgbSpace() ? even_.rgbSpace() : odd_.rgbSpace(); }
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    // A step has no slope.
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery&) const noexcept override;
    Spectrum spectrum(const TextureQuery&, const Wavelengths&) const noexcept override;
    Spectrum lightFactor(const TextureQuery&, const Wavelengths&) const noexcept override;

  private:
    double oddShare(const TextureQuery&) const;

    TexturePart even_, odd_;
    bool solid_;
    double frequency_; // checks per unit of uv, or per m
};

// The share of odd intervals [1, 2), [3, 4), … within `half` of x.
double oddShare(double x, double half);

schema::TypeInfo checkerTextureType();

} // namespace abbe
