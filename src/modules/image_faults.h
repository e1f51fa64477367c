// What the parts of the module share.
#pragma once

#include "textures/image_module.h"

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <string>

namespace abbe_images {

template <std::size_t N> void copyText(char (&to)[N], const std::string& text) {
    const std::size_t n = std::min(text.size(), N - 1);
    std::copy_n(text.data(), n, to);
    to[n] = 0;
}

// Runs `body`, which returns a reason or nothing; no exception crosses the interface.
template <typename F> std::int32_t guarded(AbbeImageFault* fault, const F& body) {
    std::string reason;
    fault->kind = abbeFaultOfSource;
    try {
        reason = body();
    } catch (const std::bad_alloc&) {
        reason = "it needs more memory than there is";
        fault->kind = abbeFaultOfMemory;
    } catch (const std::exception& e) {
        reason = e.what();
    }
    if (reason.empty()) return 1;
    copyText(fault->reason, reason);
    return 0;
}

inline std::string orElse(std::string reason, const char* otherwise) {
    return reason.empty() ? std::string(otherwise) : reason;
}

// Colours as they are stored, not multiplied by the alpha channel.
inline OIIO::ImageSpec asStored() {
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    return hints;
}

// The first image of a file, if it can be a texture and the file can hold what its header promises; else the reason.
std::unique_ptr<OIIO::ImageInput> openPicture(const std::string& path, std::string& reason);
// How many bytes OpenImageIO takes at the most, as stored, to give its rows one after the other.
double bytesAtOnce(const OIIO::ImageInput&, const std::string& path);
inline int usedChannels(const OIIO::ImageSpec& spec) { return spec.nchannels >= 3 ? 3 : 1; }

std::int32_t convert(const char* from, const char* to, const AbbeConversion*, AbbeImageFault*);
void* openSystem(std::int64_t bytes, AbbeImageFault*);
void closeSystem(void* system);
void* openTexture(void* system, const char* path, AbbeImageFault*);
std::int32_t lookup(void* system, void* texture, const AbbeTextureLookup*, float* result);
void lookupFault(void* system, AbbeImageFault*);
void statistics(void* system, AbbeTextureStatistics*);

} // namespace abbe_images
