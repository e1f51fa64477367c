#include "io/png_writer.h"

#include "base/check.h"
#include "io/file.h"

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <fmt/format.h>
#include <png.h>

namespace abbe {

namespace {

// What libpng's callbacks see. libpng is C: no exception may pass through it, so errors jump.
struct Encoder {
    std::vector<char> bytes;
    std::string error;
};

void onError(png_structp png, png_const_charp message) {
    static_cast<Encoder*>(png_get_error_ptr(png))->error = message;
    png_longjmp(png, 1);
}
void onWarning(png_structp, png_const_charp) {}
void onWrite(png_structp png, png_bytep data, png_size_t size) {
    auto& bytes = static_cast<Encoder*>(png_get_io_ptr(png))->bytes;
    bytes.insert(bytes.end(), data, data + size);
}
void onFlush(png_structp) {}

// NaN becomes 0: min and max return their first operand then.
std::uint16_t quantise(float value, float largest) {
    const float clamped = std::min(1.f, std::max(0.f, value));
    return static_cast<std::uint16_t>(std::lround(clamped * largest));
}

std::vector<png_byte> quantiseRow(std::span<const float> rgb, int bits) {
    std::vector<png_byte> row;
    row.reserve(rgb.size() * static_cast<std::size_t>(bits / 8));
    for (const float v : rgb) {
        const std::uint16_t q = quantise(v, bits == 16 ? 65535 : 255);
        if (bits == 16) row.push_back(static_cast<png_byte>(q >> 8)); // the high byte comes first
        row.push_back(static_cast<png_byte>(q & 0xff));
    }
    return row;
}

std::vector<png_text> makeTexts(const PngPicture& p) {
    std::vector<png_text> texts;
    for (const auto& [keyword, text] : p.texts) {
        png_text t{};
        const bool compressed = text.size() > 1000;
        // UTF-8 text; the keyword stays Latin-1.
        t.compression = compressed ? PNG_ITXT_COMPRESSION_zTXt : PNG_ITXT_COMPRESSION_NONE;
        t.key = const_cast<png_charp>(keyword.c_str());
        t.text = const_cast<png_charp>(text.c_str());
        t.itxt_length = text.size();
        texts.push_back(t);
    }
    return texts;
}

// Nothing with a destructor may live in this frame, which png_longjmp leaves.
bool encode(png_structp png, png_infop info, const PngPicture& p, const std::vector<png_text>& texts,
            const std::vector<std::vector<png_byte>>& rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
    png_set_IHDR(png, info, static_cast<png_uint_32>(p.width), static_cast<png_uint_32>(p.height), p.bits,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (p.srgb) png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (!texts.empty()) png_set_text(png, info, texts.data(), static_cast<int>(texts.size()));
    png_write_info(png, info);
    for (const auto& row : rows) png_write_row(png, row.data());
    png_write_end(png, info);
    return true;
}

} // namespace

std::vector<char> encodePng(const PngPicture& p) {
    ABBE_CHECK(p.width > 0 && p.height > 0 && (p.bits == 8 || p.bits == 16));
    const std::size_t stride = 3 * static_cast<std::size_t>(p.width);
    ABBE_CHECK(p.rgb.size() == stride * static_cast<std::size_t>(p.height));
    std::vector<std::vector<png_byte>> rows;
    for (std::size_t y = 0; y < static_cast<std::size_t>(p.height); ++y)
        rows.push_back(quantiseRow(p.rgb.subspan(y * stride, stride), p.bits));
    const auto texts = makeTexts(p);

    Encoder encoder;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &encoder, onError, onWarning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
        png_destroy_write_struct(&png, nullptr);
        throw IoError("out of memory");
    }
    png_set_write_fn(png, &encoder, onWrite, onFlush);
    const bool good = encode(png, info, p, texts, rows);
    png_destroy_write_struct(&png, &info);
    if (!good) throw IoError(encoder.error);
    return std::move(encoder.bytes);
}

void writePng(const std::string& path, const PngPicture& p) {
    std::vector<char> bytes;
    try {
        bytes = encodePng(p);
    } catch (const IoError& e) {
        throw IoError(fmt::format("cannot write `{}`: {}", path, e.what()));
    }
    writeAtomically(path, bytes);
}

} // namespace abbe
