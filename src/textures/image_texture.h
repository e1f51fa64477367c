// Images laid over texture coordinates, one file or UDIM tiles.
#pragma once

#include "base/diagnostic.h"
#include "render/texture.h"
#include "schema/type.h"
#include "textures/spline_image.h"
#include "textures/texture_store.h"

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace abbe {

struct ImageTextureParams {
    schema::Text file; // resolved path, perhaps with <UDIM>
    schema::Choice wrap;
    schema::Choice take;
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

// What went wrong in the lookups of a texture while rendering.
// Counts from many threads; nothing happens to it as long as all is well.
class LookupFaults {
  public:
    enum Kind { coordinates, missingTile, failedRead, notFinite };

    void add(Kind kind) noexcept { counts_[kind].fetch_add(1, std::memory_order_relaxed); }
    std::uint64_t count(Kind kind) const noexcept { return counts_[kind].load(std::memory_order_relaxed); }
    bool unreadable() const noexcept { return unreadable_.load(std::memory_order_relaxed); }
    // True for the first caller alone, who is to say why.
    bool firstUnreadable() noexcept { return !unreadable_.exchange(true, std::memory_order_relaxed); }
    void say(std::string text) {
        const std::lock_guard lock(mutex_);
        example_ = std::move(text);
    }
    std::string example() const {
        const std::lock_guard lock(mutex_);
        return example_;
    }

  private:
    std::atomic<std::uint64_t> counts_[4] = {};
    std::atomic<bool> unreadable_ = false;
    mutable std::mutex mutex_;
    std::string example_; // why tiles could not be read
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
    // The parts of prepare().
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
