// Gradients: values at stops, in between linear.
#pragma once

#include "textures/texture_part.h"

#include <memory>
#include <optional>
#include <vector>

namespace abbe {

struct RampTextureParams {
    std::vector<schema::SpectrumStop> stops;
    schema::Choice over{"u", std::nullopt};
    schema::TexturedNumber input = {};
};

// A function of u, v, a coordinate in the shape's own space (m), or the first channel of another texture, or a number
// that is the same everywhere. Between stops spectra are mixed linearly, wavelength by wavelength; beyond the ends it
// is constant. The mean over the footprint is exact for a box along the coordinate.
class RampTexture final : public Texture {
  public:
    enum class Over : std::uint8_t { u, v, x, y, z, input };
    // Requires at least one stop, positions finite and in order.
    RampTexture(std::vector<schema::SpectrumStop>, Over, const schema::TexturedNumber& input = {});

    int channels() const override { return 3; }
    bool needsUv() const override;
    const RgbSpace* rgbSpace() const override;
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery&) const noexcept override;
    Spectrum spectrum(const TextureQuery&, const Wavelengths&) const noexcept override;
    Spectrum lightFactor(const TextureQuery&, const Wavelengths&) const noexcept override;

  private:
    struct Stop {
        double position;
        TexturePart part;
    };
    // Calls add(part, weight) for the parts of the mean over the footprint; weights sum to 1.
    template <typename Add> void mean(const TextureQuery&, Add) const;
    template <typename Add> void weigh(double from, double to, Add) const;

    std::vector<Stop> stops_;
    Over over_;
    const Texture* input_; // of Over::input; null: the number
    float number_;
};

schema::TypeInfo rampTextureType();
// Null after an error.
std::unique_ptr<Texture> makeRampTexture(const RampTextureParams&, Diagnostics&);

} // namespace abbe
