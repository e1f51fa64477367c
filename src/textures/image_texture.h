// Images laid over texture coordinates, one file or UDIM tiles.
#pragma once

#include "base/diagnostic.h"
#include "render/texture.h"
#include "schema/type.h"
#include "textures/image_file.h"

#include <map>
#include <memory>

namespace abbe {

struct ImageTextureParams {
    schema::Text file; // resolved path, perhaps with <UDIM>
    schema::Choice wrap;
};

// What lies outside the unit square of texture coordinates.
enum class Wrap : std::uint8_t { periodic, clamp, mirror, black };

// Uniform cubic B-splines with the texels as control points: twice continuously differentiable, so that displaced
// normals and their highlights are smooth, and never outside the range of the texels. The price is a blur of 0.58
// texels (standard deviation); Catmull-Rom would interpolate, but its second derivative jumps and it overshoots.
// Texel centres lie at half-integers; v = 0 is the lower edge.
class ImageTexture final : public Texture {
  public:
    ImageTexture(ImagePixels, Wrap);
    // Tiles by number: 1001 + column + 10 row, as floor(u) and floor(v) count. Lookups near a border stay in the tile.
    explicit ImageTexture(std::map<int, ImagePixels> tiles);

    int channels() const override { return channels_; }
    bool needsUv() const override { return true; }
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    bool covers(Vec2 uv) const noexcept override;

  private:
    const ImagePixels* tileOf(const TexturePoint&, double& u, double& v) const noexcept;

    std::map<int, ImagePixels> tiles_; // 1001 alone unless tiled_
    bool tiled_ = false;
    Wrap wrap_ = Wrap::periodic;
    int channels_ = 1;
};

schema::TypeInfo imageTextureType();
// Reads the files; null after an error.
std::unique_ptr<Texture> makeImageTexture(const ImageTextureParams&, Diagnostics&);

} // namespace abbe
