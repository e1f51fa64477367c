// Fractal noise in space: no texture coordinates and no files.
#pragma once

#include "render/texture.h"
#include "schema/type.h"

#include <vector>

namespace abbe {

struct NoiseTextureParams {
    double scale = 0.1; // m
    std::int64_t octaves = 4;
    double lacunarity = 2;
    double gain = 0.5;
    std::int64_t seed = 0;
};

// Gradient noise with quintic blending [Perlin2002], twice continuously differentiable, summed over octaves: 0.5 + Σ
// gain^k n(p lacunarity^k / scale) / (2 Σ gain^k). Always within 0 … 1 and 0.5 on average; octaves are shifted against
// each other, so that their zeros do not coincide. A pure function of the position and the parameters. Three channels
// are three independent noises.
class NoiseTexture final : public Texture {
  public:
    explicit NoiseTexture(const NoiseTextureParams&);

    int channels() const override { return 3; }
    bool needsUv() const override { return false; }
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    // Octaves fade out as the footprint grows across their bumps, as averaging over it makes them.
    Vec3 value(const TextureQuery&) const noexcept override;
    float number(const TextureQuery& query) const noexcept override { return channel(query, 0); }
    Spectrum spectrum(const TextureQuery&, const Wavelengths&) const noexcept override;

  private:
    float channel(const TextureQuery&, int) const noexcept;

    struct Octave {
        double frequency, weight;
        struct {
            std::uint32_t seed;
            Vec3d shift;
        } channels[3];
    };
    std::vector<Octave> octaves_;
};

schema::TypeInfo noiseTextureType();

} // namespace abbe
