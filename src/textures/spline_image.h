// Whole images as smooth surfaces over texture coordinates, one file or UDIM tiles: for displacement and bumps.
#pragma once

#include "render/texture.h"
#include "textures/image_file.h"

#include <cstdint>
#include <map>

namespace abbe {

// What lies outside the unit square of texture coordinates.
enum class Wrap : std::uint8_t { periodic, clamp, mirror, black };

// Uniform cubic B-splines with the texels as control points: twice continuously differentiable, so that displaced
// normals and their highlights are smooth, and never outside the range of the texels. The price is a blur of 0.58
// texels (standard deviation); Catmull-Rom would interpolate, but its second derivative jumps and it overshoots.
// Texel centres lie at half-integers; v = 0 is the lower edge. Immutable; shared between threads.
class SplineImage {
  public:
    SplineImage(ImagePixels, Wrap);
    // Tiles by number: 1001 + column + 10 row, as floor(u) and floor(v) count. Lookups near a border stay in the tile.
    explicit SplineImage(std::map<int, ImagePixels> tiles);

    // As Texture::jet. Requires as many channels in every tile.
    TextureJet jet(const TexturePoint&, int channels) const noexcept;

  private:
    const ImagePixels* tileOf(const TexturePoint&, double& u, double& v) const noexcept;

    std::map<int, ImagePixels> tiles_; // 1001 alone unless tiled_
    bool tiled_ = false;
    Wrap wrap_ = Wrap::periodic;
};

} // namespace abbe
