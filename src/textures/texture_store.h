// The texture system of a scene: pictures on disk, tiles of them in memory up to a limit.
#pragma once

#include "spectrum/upsampling_table.h"
#include "textures/texture_file.h"

#include <map>
#include <memory>

namespace abbe {

struct TextureStoreSettings {
    std::int64_t bytes = std::int64_t{2} << 30;                       // of tiles in memory
    std::filesystem::path directory = textureCacheDirectory();        // of converted pictures; empty: none
    std::filesystem::path tables = UpsamplingTable::cacheDirectory(); // of upsampling tables
    bool open = true; // false: pictures are only looked at, as for a check of the scene
};

// Filled on one thread; then const and shared between threads. Lookups do not allocate but for tiles.
class TextureStore {
  public:
    explicit TextureStore(TextureStoreSettings);
    ~TextureStore();
    TextureStore(const TextureStore&) = delete;
    TextureStore& operator=(const TextureStore&) = delete;

    const TextureStoreSettings& settings() const { return settings_; }
    // Made or loaded with the first call for a space.
    const UpsamplingTable& upsampling(const RgbSpace&);
    // Of a file that textureFile() gave, for as long as the store lives. Throws ImageFileError.
    void* open(const std::string& path);
    // False if tiles could not be read.
    bool lookup(void* texture, const AbbeTextureLookup& l, float* result) const noexcept {
        return module_->lookup(system_, texture, &l, result) != 0;
    }
    // Why the last lookup of this thread failed.
    std::string lookupFault() const;
    AbbeTextureStatistics statistics() const;

  private:
    TextureStoreSettings settings_;
    const AbbeImageModule* module_ = nullptr; // with the first picture
    void* system_ = nullptr;
    std::map<std::string_view, std::unique_ptr<const UpsamplingTable>> tables_; // by name of the space
};

} // namespace abbe
