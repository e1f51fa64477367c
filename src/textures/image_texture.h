// Images laid over texture coordinates, one file or UDIM tiles.
#pragma once

#include "base/diagnostic.h"
#include "render/texture.h"
#include "schema/type.h"
#include "textures/lookup_faults.h"
#include "textures/spline_image.h"
#include "textures/texture_store.h"

#include <map>
#include <memory>
#include <optional>

namespace abbe {

struct ImageTextureParams {
    schema::Text file; // resolved path, perhaps with <UDIM>
    schema::Choice wrap;
};

// One picture: what its header says, and where the texture system has it.
struct ImageTile {
    std::string path;
    AbbeImageInfo info{};
    std::string opened;     // the file behind `handle`
    void* handle = nullptr; // null until prepared for shading
    bool stored = false;    // its values are decoded after filtering
};

// How the values of a picture are to be read.
struct ImageEncoding {
    const ColorEncoding* encoding;
    bool said = false;    // by the scene or by a tag, rather than guessed from the type of the file
    bool inScene = false; // by the scene
};

// For shading, pictures stay on disk and are filtered by the texture system; for displacement they are in memory
// whole. A texture does what it was prepared for. v = 0 is the lower edge. Tiles never wrap, and lookups do not
// reach across their borders.
class ImageTexture final : public Texture {
  public:
    // Tiles by number: 1001 + column + 10 row, as floor(u) and floor(v) count; a picture alone is 1001.
    ImageTexture(std::map<int, ImageTile>, bool tiled, Wrap, ImageEncoding, schema::Text asked,
                 std::shared_ptr<TextureStore>);

    int channels() const override { return channels_; }
    bool needsUv() const override { return true; }
    const RgbSpace* rgbSpace() const override { return encoding_.encoding->space; }
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery&) const noexcept override;
    Spectrum spectrum(const TextureQuery&, const Wavelengths&) const noexcept override;
    Spectrum lightFactor(const TextureQuery&, const Wavelengths&) const noexcept override;
    bool covers(Vec2 uv) const noexcept override;
    void reportLookups(Diagnostics&) const override;

  private:
    const ImageTile* tileOf(double& u, double& v) const noexcept;
    // image_prepare.cpp
    void warnOfUse(TextureUse, Span user, Diagnostics&);
    bool prepareHeights(Diagnostics&);
    bool prepareShading(TextureUse, Diagnostics&);
    void openTile(ImageTile&, Diagnostics&);
    void warnOfReflectances(Diagnostics&);

    std::map<int, ImageTile> tiles_;
    bool tiled_;
    Wrap wrap_;
    int channels_ = 3;
    ImageEncoding encoding_;
    schema::Text asked_;
    std::shared_ptr<TextureStore> store_;
    const UpsamplingTable* upsampling_ = nullptr;
    std::optional<SplineImage> heights_;
    bool warned_ = false; // of its use
    TexelCounts counts_;  // of all tiles, until reported
    mutable LookupFaults faults_;
};

schema::TypeInfo imageTextureType();
// Reads the headers of the files; null after an error.
std::unique_ptr<Texture> makeImageTexture(const ImageTextureParams&, std::shared_ptr<TextureStore>, Diagnostics&);

} // namespace abbe
