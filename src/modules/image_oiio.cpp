// The module behind textures/image_module.h, on OpenImageIO: headers, and whole images.
#include "modules/image_faults.h"

namespace abbe_images {

namespace {

// Empty, or why the image cannot be used.
std::string read(const char* path, int mostChannels, const AbbeImageSink& sink) {
    std::string reason;
    const auto file = openPicture(path, reason);
    if (!file) return reason;
    const OIIO::ImageSpec& spec = file->spec();
    const int channels = mostChannels >= 3 ? usedChannels(spec) : 1;
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    float* const pixels = sink.begin(sink.user, spec.width, spec.height, channels, space.c_str());
    if (!pixels) return "it does not fit into memory";
    if (file->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, pixels)) return {};
    return orElse(file->geterror(), "its pixels cannot be read");
}

std::int32_t readImage(const char* path, std::int32_t mostChannels, const AbbeImageSink* sink) {
    AbbeImageFault fault;
    if (guarded(&fault, [&] { return read(path, mostChannels, *sink); })) return 1;
    sink->fail(sink->user, &fault);
    return 0;
}

std::int32_t typeOf(const OIIO::ImageSpec& spec) {
    switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
    case OIIO::TypeDesc::INT8:
        return abbeTexel8;
    case OIIO::TypeDesc::UINT16:
    case OIIO::TypeDesc::INT16:
        return abbeTexel16;
    case OIIO::TypeDesc::HALF:
        return abbeTexelHalf;
    default:
        return abbeTexelFloat;
    }
}

bool hasAllLevels(OIIO::ImageInput& file) {
    const OIIO::ImageSpec first = file.spec();
    constexpr std::size_t kLargestTile = 16 << 20; // bytes; the cache holds whole ones
    if (first.tile_width < 1 || first.tile_bytes(true) > kLargestTile) return false;
    int level = 0;
    OIIO::ImageSpec last = first;
    for (OIIO::ImageSpec s = file.spec_dimensions(0, 1); s.width > 0 && level < 64;
         s = file.spec_dimensions(0, level + 1)) {
        last = s;
        ++level;
    }
    return last.width == 1 && last.height == 1;
}

std::string describe(const char* path, AbbeImageInfo& info) {
    std::string reason;
    const auto file = openPicture(path, reason);
    if (!file) return reason;
    const OIIO::ImageSpec spec = file->spec();
    info = {};
    info.width = spec.width;
    info.height = spec.height;
    info.channels = usedChannels(spec);
    info.type = typeOf(spec);
    info.isTexture = hasAllLevels(*file);
    const OIIO::ParamValue* const primaries =
        spec.find_attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8));
    info.chromatic = primaries != nullptr;
    if (primaries) std::copy_n(static_cast<const float*>(primaries->data()), 8, info.chromaticities);
    copyText(info.colorSpace,
             orElse(spec.get_string_attribute("colorInteropID"), spec.get_string_attribute("oiio:ColorSpace").c_str()));
    return {};
}

std::int32_t describeImage(const char* path, AbbeImageInfo* info, AbbeImageFault* fault) {
    return guarded(fault, [&] { return describe(path, *info); });
}

constexpr AbbeImageModule kModule = {kAbbeImageModuleVersion,
                                     readImage,
                                     describeImage,
                                     convert,
                                     openSystem,
                                     closeSystem,
                                     openTexture,
                                     lookup,
                                     lookupFault,
                                     statistics};

} // namespace

} // namespace abbe_images

extern "C" __attribute__((visibility("default"))) const AbbeImageModule* abbeImageModule() {
    return &abbe_images::kModule;
}
