// Filtered lookups through OpenImageIO's texture system.
#include "modules/image_faults.h"

#include <OpenImageIO/texture.h>
#include <atomic>
#include <memory>

namespace abbe_images {

namespace {

struct System {
    std::shared_ptr<OIIO::TextureSystem> textures; // OpenImageIO's own deleter comes with it
    std::uint64_t number = 0;
};

// What OpenImageIO keeps for a thread, found once per thread and system: systems are told apart by number, because
// one may come to lie where another was.
OIIO::TextureSystem::Perthread* ofThread(const System& system) {
    thread_local struct {
        std::uint64_t number = 0;
        OIIO::TextureSystem::Perthread* data = nullptr;
    } mine;
    if (mine.number != system.number) {
        mine.data = system.textures->get_perthread_info();
        mine.number = system.number;
    }
    return mine.data;
}

OIIO::TextureOpt::Wrap wrapOf(std::int32_t wrap) {
    switch (wrap) {
    case abbeWrapClamp:
        return OIIO::TextureOpt::WrapClamp;
    case abbeWrapMirror:
        return OIIO::TextureOpt::WrapMirror;
    case abbeWrapBlack:
        return OIIO::TextureOpt::WrapBlack;
    default:
        return OIIO::TextureOpt::WrapPeriodic;
    }
}

constexpr int kMostOpenFiles = 256;

} // namespace

void* openSystem(std::int64_t bytes, AbbeImageFault* fault) {
    static std::atomic<std::uint64_t> systems{0};
    System* made = nullptr;
    guarded(fault, [&]() -> std::string {
        auto* const textures = OIIO::TextureSystem::create(false);
        if (!textures) return "OpenImageIO has no texture system";
        made = new System{{textures, [](OIIO::TextureSystem* t) { OIIO::TextureSystem::destroy(t); }}, ++systems};
        textures->attribute("max_memory_MB", static_cast<float>(static_cast<double>(bytes) / (1 << 20)));
        textures->attribute("max_open_files", kMostOpenFiles);
        textures->attribute("gray_to_rgb", 1);
        // For files that could not be converted.
        textures->attribute("automip", 1);
        textures->attribute("autotile", 64);
        textures->attribute("unassociatedalpha", 1);
        return {};
    });
    return made;
}

void closeSystem(void* system) { delete static_cast<System*>(system); }

void* openTexture(void* system, const char* path, AbbeImageFault* fault) {
    auto& s = *static_cast<System*>(system);
    void* handle = nullptr;
    guarded(fault, [&]() -> std::string {
        const OIIO::ustring name(path);
        auto* const found = s.textures->get_texture_handle(name, ofThread(s));
        if (!found || !s.textures->good(found)) return orElse(s.textures->geterror(), "it cannot be opened");
        handle = found;
        return {};
    });
    return handle;
}

std::int32_t lookup(void* system, void* texture, const AbbeTextureLookup* l, float* result) {
    auto& s = *static_cast<System*>(system);
    OIIO::TextureOpt options;
    options.swrap = options.twrap = wrapOf(l->wrap);
    options.anisotropic = 16;
    options.firstchannel = l->first;
    try {
        return s.textures->texture(static_cast<OIIO::TextureSystem::TextureHandle*>(texture), ofThread(s), options,
                                   l->s, l->t, l->dsdx, l->dtdx, l->dsdy, l->dtdy, l->channels, result);
    } catch (...) { // no memory for a tile: as one that cannot be read
        return 0;
    }
}

void lookupFault(void* system, AbbeImageFault* fault) {
    copyText(fault->reason, static_cast<System*>(system)->textures->geterror());
}

void statistics(void* system, AbbeTextureStatistics* result) {
    const auto& textures = *static_cast<System*>(system)->textures;
    *result = {};
    long long used = 0, read = 0;
    int tiles = 0;
    textures.getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &used);
    textures.getattribute("stat:bytes_read", OIIO::TypeDesc::INT64, &read);
    textures.getattribute("stat:tiles_created", tiles);
    result->cacheBytes = used;
    result->bytesRead = read;
    result->tilesRead = tiles;
}

} // namespace abbe_images
