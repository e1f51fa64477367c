// Pictures in the form that lookups need: tiled, with mip levels, linear; converted once and kept in a cache on disk.
#pragma once

#include "spectrum/color_encoding.h"
#include "textures/image_file.h"

#include <cstdint>
#include <filesystem>
#include <string>

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

} // namespace abbe
