// The pictures of a scene as lookups need them: tiled, with mip levels, linear, converted once and kept in a cache on
// disk; and the texture system that has tiles of them in memory, up to a limit.
#pragma once

#include "base/file.h"
#include "spectrum/color_space.h"
#include "spectrum/upsampling_table.h"
#include "textures/image_file.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

namespace abbe {

class UpsamplingTable;

// What a conversion found in the texels of a picture; it stays with the converted file.
struct TexelCounts {
    std::uint64_t texels = 0;     // 0: nothing is known
    std::uint64_t negative = 0;   // colours with a negative channel, which became 0
    std::uint64_t above = 0;      // colours with a channel above 1, which were kept
    std::uint64_t sampled = 0;    // colours within 0 … 1 that were compared with the reflectance made of them,
    std::uint64_t impossible = 0; // those of them that no reflectance has

    TexelCounts& operator+=(const TexelCounts& other) {
        texels += other.texels;
        negative += other.negative;
        above += other.above;
        sampled += other.sampled;
        impossible += other.impossible;
        return *this;
    }
};

struct TextureFile {
    std::string path;
    TexelCounts counts;
    bool stored = false; // the values are still encoded: decode after filtering
    std::string problem; // why it had to be the picture itself, or empty
};

// The picture has values that are not finite.
struct NotFiniteError : ImageFileError {
    explicit NotFiniteError(std::uint64_t values);
    std::uint64_t count;
};

// The file to be given to the texture system for a picture whose values are to be read as `encoding`: the picture
// itself if it is already a linear texture; else a converted file out of `directory` (empty: no cache), which is made
// if it is missing, damaged or older than the picture; else, with a problem, the picture itself. Colours are compared
// with `upsampling`, which may be null. Several threads and processes may ask for the same file at once. Throws
// ImageFileError if the picture cannot be read,
// std::bad_alloc if that takes more memory than there is.
TextureFile textureFile(const std::string& picture, const AbbeImageInfo&, const ColorEncoding& encoding,
                        const std::filesystem::path& directory, const UpsamplingTable* upsampling);

// Removes a converted file that turned out to be unreadable; leaves other files alone.
void forgetTextureFile(const std::string& path, const std::filesystem::path& directory);

// $XDG_CACHE_HOME/abbe/textures, else ~/.cache/abbe/textures; empty (no cache) without either.
std::filesystem::path textureCacheDirectory();

struct TextureStoreSettings {
    std::int64_t bytes = std::int64_t{2} << 30;                       // of tiles in memory
    std::filesystem::path directory = textureCacheDirectory();        // of converted pictures; empty: none
    std::filesystem::path tables = UpsamplingTable::cacheDirectory(); // of upsampling tables
    bool open = true; // false: pictures are only looked at, as for a check of the scene

    bool operator==(const TextureStoreSettings&) const = default;
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
    // textureFile() into its directory, remembered for as long as the picture stays the same.
    TextureFile file(const std::string& picture, const AbbeImageInfo&, const ColorEncoding&, const UpsamplingTable*);
    // Of a file that file() gave, for as long as the store lives. Throws ImageFileError.
    void* open(const std::string& path);
    // False if tiles could not be read.
    bool lookup(void* texture, const AbbeTextureLookup& l, float* result) const noexcept {
        if (module_->lookup(system_, texture, &l, result) != 0) return true;
        damaged_.store(true, std::memory_order_relaxed);
        return false;
    }
    // Whether it may serve for another building of a scene: what it opened is still the same, and could be read.
    bool isCurrent() const;
    // Files since the last call: opened for the first time, and those that were open already.
    struct Opened {
        std::size_t anew = 0, again = 0;
    };
    Opened takeOpened() { return std::exchange(opened_, {}); }
    // Why the last lookup of this thread failed.
    std::string lookupFault() const;
    AbbeTextureStatistics statistics() const;

  private:
    TextureStoreSettings settings_;
    const AbbeImageModule* module_ = nullptr; // with the first picture
    void* system_ = nullptr;
    std::map<std::string_view, std::unique_ptr<const UpsamplingTable>> tables_; // by name of the space
    struct Known {
        FileIdentity picture;
        TextureFile file;
    };
    std::map<std::tuple<std::string, std::string_view, std::int32_t>, Known> files_; // by picture, encoding, channel
    std::map<std::string, FileIdentity> textures_;                                   // that are open
    Opened opened_;
    mutable std::atomic<bool> damaged_ = false;
};

} // namespace abbe
