// The module behind textures/image_module.h, on OpenImageIO: headers, and whole images.
#include "modules/image_faults.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>

namespace abbe_images {

namespace {

// Empty, or why the image cannot be used.
std::string read(const char* path, int first, int mostChannels, const AbbeImageSink& sink) {
    std::string reason;
    const auto file = openPicture(path, reason);
    if (!file) return reason;
    const OIIO::ImageSpec& spec = file->spec();
    const int channels = mostChannels >= 3 ? usedChannels(spec) : 1;
    if (first < 0 || first + channels > spec.nchannels) return "it has too few channels";
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    float* const pixels = sink.begin(sink.user, spec.width, spec.height, channels, space.c_str());
    if (!pixels) return "it does not fit into memory";
    if (file->read_image(0, 0, first, first + channels, OIIO::TypeDesc::FLOAT, pixels)) return {};
    return orElse(file->geterror(), "its pixels cannot be read");
}

std::int32_t readImage(const char* path, std::int32_t first, std::int32_t mostChannels, const AbbeImageSink* sink) {
    AbbeImageFault fault;
    if (guarded(&fault, [&] { return read(path, first, mostChannels, *sink); })) return 1;
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
    info.alpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels ? spec.alpha_channel : -1;
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

namespace abbe_images {

// Opening a picture: what its header promises is held against the file before anything is decoded.

namespace {

constexpr int kLongestSide = 1 << 20; // pixels

std::string unusable(const OIIO::ImageSpec& spec) {
    if (spec.deep) return "it holds deep samples, not pixels";
    if (spec.depth > 1) return "it holds a volume";
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) return "it has no pixels";
    if (spec.width > kLongestSide || spec.height > kLongestSide)
        return "a side of more than " + std::to_string(kLongestSide) + " pixels is too long";
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height)
        return "only a part of the picture is in it (its data window is not its display window)";
    return {};
}

// The first bytes of a file; nothing if there are fewer.
template <std::size_t N> std::optional<std::array<unsigned char, N>> headOf(const std::string& path) {
    std::array<unsigned char, N> bytes{};
    std::FILE* const file = std::fopen(path.c_str(), "rb");
    if (!file) return std::nullopt;
    const std::size_t got = std::fread(bytes.data(), 1, N, file);
    std::fclose(file);
    return got == N ? std::optional(bytes) : std::nullopt;
}

// What the first chunk of a PNG says [ISO 15948, 11.2.2]; nothing of other files.
struct PngHead {
    double rowBytes = 0; // of stored rows
    bool interlaced = false;
};

PngHead pngHead(const std::string& path, int width) {
    const auto head = headOf<29>(path);
    if (!head || std::memcmp(head->data(), "\x89PNG\r\n\x1a\n", 8) != 0) return {};
    const auto& b = *head;
    constexpr std::array<int, 7> kChannels{1, 0, 3, 1, 2, 0, 4}; // by the type of colour
    const int channels = b[25] < kChannels.size() ? kChannels[b[25]] : 4;
    return {1 + static_cast<double>(width) * b[24] * channels / 8, b[28] != 0};
}

// OpenImageIO takes memory for the whole canvas of a GIF as it opens it: so this one is asked before. 2560 is what LZW
// of 12 bits makes of a byte.
bool isGifBeyondItsBytes(const std::string& path) {
    const auto head = headOf<10>(path);
    if (!head || std::memcmp(head->data(), "GIF", 3) != 0) return false;
    const auto& b = *head;
    std::error_code error;
    const double pixels = (b[6] + 256.0 * b[7]) * (b[8] + 256.0 * b[9]);
    return pixels > 2560 * static_cast<double>(std::filesystem::file_size(path, error));
}

// How many bytes a format makes of one at the most; 0: that is not known. Deflate makes 1032 of one, LZW of 12 bits
// 2560, runs are of 127 or 255; a palette or bits make up to 32 of one once more.
double mostExpansion(std::string_view format, const OIIO::ImageSpec& spec) {
    constexpr double kPalette = 32;
    if (format == "jpeg") return 2048; // a bit for each block of 64 pixels
    if (format == "hdr") return 768;
    if (format == "targa") return 128 * kPalette;
    if (format == "bmp") return 128 * kPalette;
    if (format == "gif") return 2560 * kPalette;
    if (format == "pnm") return 8;
    if (format != "tiff") return 0;
    const std::string packing = spec.get_string_attribute("compression");
    return packing == "none"       ? kPalette
           : packing == "lzw"      ? 2560 * kPalette
           : packing == "zip"      ? 1032 * kPalette
           : packing == "packbits" ? 64 * kPalette
                                   : 0;
}

std::string beyondItsBytes(const OIIO::ImageInput& file, const std::string& path) {
    const OIIO::ImageSpec& spec = file.spec();
    std::error_code error;
    const auto stored = static_cast<double>(std::filesystem::file_size(path, error));
    if (error) return error.message();
    const PngHead png = pngHead(path, spec.width);
    const bool isPng = png.rowBytes > 0;
    const double most = isPng ? 1032 : mostExpansion(file.format_name(), spec);
    const double promised = isPng ? png.rowBytes * spec.height : static_cast<double>(spec.image_bytes(true));
    if (most == 0 || promised <= most * stored) return {};
    return "it is cut short or damaged: " + std::to_string(spec.width) + " by " + std::to_string(spec.height) +
           " pixels cannot be in " + std::to_string(static_cast<long long>(stored)) + " bytes";
}

} // namespace

std::unique_ptr<OIIO::ImageInput> openPicture(const std::string& path, std::string& reason) {
    if (isGifBeyondItsBytes(path)) {
        reason = "it is cut short or damaged: its canvas cannot be in so few bytes";
        return nullptr;
    }
    const OIIO::ImageSpec hints = asStored();
    auto file = OIIO::ImageInput::open(path, &hints);
    reason = file ? unusable(file->spec()) : orElse(OIIO::geterror(), "it cannot be opened");
    if (reason.empty()) reason = beyondItsBytes(*file, path);
    if (!reason.empty()) file.reset();
    return file;
}

double bytesAtOnce(const OIIO::ImageInput& file, const std::string& path) {
    const OIIO::ImageSpec& spec = file.spec();
    const std::string_view format = file.format_name();
    const bool byRows = format == "openexr" || format == "tiff" || (format == "png" && !pngHead(path, 1).interlaced);
    if (!byRows) return static_cast<double>(spec.image_bytes(true));
    constexpr int kMostRows = 256; // of a chunk of OpenEXR
    const int rows = std::min(spec.height, spec.tile_height > 0 ? spec.tile_height : kMostRows);
    return static_cast<double>(spec.scanline_bytes(true)) * rows;
}

} // namespace abbe_images
