// The interface between the program and the module that reads image files: plain C, so that neither side sees the
// other's libraries. The module is a shared object of its own, loaded when a scene first names an image texture.
#pragma once

#include <cstdint>

extern "C" {

enum AbbeFaultKind : std::int32_t {
    abbeFaultOfSource, // what is read
    abbeFaultOfResult, // what a conversion writes
    abbeFaultOfMemory, // there is too little
};

// Texts are cut where they do not fit.
struct AbbeImageFault {
    char reason[512];
    std::int32_t kind; // AbbeFaultKind
};

struct AbbeImageSink {
    void* user;
    // Called once, before the pixels. `colorSpace` is how the file is tagged, or empty. Returns where
    // width * height * channels floats go (rows from the top, channels interleaved), or null to stop.
    float* (*begin)(void* user, int width, int height, int channels, const char* colorSpace);
    // Called once after any fault, with its reason.
    void (*fail)(void* user, const AbbeImageFault*);
};

enum AbbeTexelType : std::int32_t { abbeTexel8, abbeTexel16, abbeTexelHalf, abbeTexelFloat };

// What the header of an image file says about its first image.
struct AbbeImageInfo {
    std::int32_t width, height;
    std::int32_t channels;   // 3 if the file has three or more, else 1
    std::int32_t first;      // the first of them, 0
    std::int32_t alpha;      // the channel of alpha, or -1
    std::int32_t type;       // AbbeTexelType
    std::int32_t isTexture;  // tiled, with all its mip levels
    std::int32_t chromatic;  // whether `chromaticities` are in it
    float chromaticities[8]; // x, y of red, green, blue and white
    char colorSpace[64];     // how it is tagged, or empty
};

// A picture in memory: rows from the top, channels interleaved.
struct AbbePixels {
    std::int32_t width, height, channels;
    std::int32_t type; // abbeTexel8 or abbeTexelFloat
    const void* values;
};

// From any picture to a tiled one with mip levels: each level is the exact mean of the one before. Needs memory for a
// few rows only; what a level leaves for the next one lies in temporary files beside the result.
struct AbbeConversion {
    std::int32_t first, channels; // of the picture; 1 or 3
    std::int32_t type;            // AbbeTexelType of the result
    double memory;                // bytes that it may take: known to need more, it does not begin
    void* user;
    // Changes texels of the picture in place, before any averaging. 0 to stop.
    std::int32_t (*texels)(void* user, float* values, std::int64_t count);
    const AbbePixels* pixels; // the picture, in the place of a file; or null
};

enum AbbeWrap : std::int32_t { abbeWrapPeriodic, abbeWrapClamp, abbeWrapMirror, abbeWrapBlack };

// The mean over an ellipse, in OpenImageIO's coordinates: t = 0 is the upper edge. The derivatives are the whole widths
// of the ellipse.
struct AbbeTextureLookup {
    float s, t, dsdx, dtdx, dsdy, dtdy;
    std::int32_t wrap; // AbbeWrap
    std::int32_t first, channels;
};

struct AbbeTextureStatistics {
    std::int64_t bytesRead, cacheBytes, tilesRead;
};

// Functions return 1, or 0 after a fault with its reason. Everything but openSystem and closeSystem may be called by
// several threads at once.
struct AbbeImageModule {
    std::int32_t version; // kAbbeImageModuleVersion
    // Reads `mostChannels` channels of the first image of a file, or as many as there are, from the channel `first` on.
    std::int32_t (*read)(const char* path, std::int32_t first, std::int32_t mostChannels, const AbbeImageSink*);
    std::int32_t (*describe)(const char* path, AbbeImageInfo*, AbbeImageFault*);
    std::int32_t (*convert)(const char* from, const char* to, const AbbeConversion*, AbbeImageFault*);
    // A cache of tiles of at most so many bytes. Null after a fault.
    void* (*openSystem)(std::int64_t bytes, AbbeImageFault*);
    void (*closeSystem)(void* system);
    // A file for lookups; null after a fault. It lives as long as the system.
    void* (*openTexture)(void* system, const char* path, AbbeImageFault*);
    std::int32_t (*lookup)(void* system, void* texture, const AbbeTextureLookup*, float* result);
    // Why lookups failed; clears it.
    void (*lookupFault)(void* system, AbbeImageFault*);
    void (*statistics)(void* system, AbbeTextureStatistics*);
};

inline constexpr std::int32_t kAbbeImageModuleVersion = 5;

using AbbeGetImageModule = const AbbeImageModule* (*)();
// The name of that function in the module.
inline constexpr const char* kAbbeGetImageModule = "abbeImageModule";
}
