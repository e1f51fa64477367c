// OpenEXR output: files, and channels added to files that exist.
#pragma once

#include "io/image.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace abbe {

enum class ExrCompression : std::uint8_t { none, rle, zips, zip, piz, pxr24, dwaa, dwab };
// By the name in a scene file, which is the enumerator's.
std::optional<ExrCompression> findExrCompression(std::string_view name);
std::string_view name(ExrCompression);

// One fact about how an image was made. Numbers beyond int are given as text.
struct ImageAttribute {
    std::string name;
    std::variant<std::string, int, double> value;
};

// A plane of the data window, row by row from the top.
struct ExrChannel {
    std::string name;
    std::span<const float> values;
};

struct ExrPicture {
    PixelWindow window;  // data window: the rendered part
    PixelWindow display; // the whole picture
    std::span<const float> r, g, b;
    std::vector<ExrChannel> more = {}; // "variance.Y", …; always float
    Chromaticities chromaticities = {};
    std::optional<Chromaticity> adoptedNeutral = {}; // their white, if not given
    ExrCompression compression = ExrCompression::zip;
    bool half = false;          // R G B in 16 bits
    bool acesContainer = false; // SMPTE ST 2065-4. Requires half, no compression and the primaries of ACES2065-1
    std::vector<ImageAttribute> attributes = {};
    // One part for R G B, with all attributes, and one for each layer of `more` ("albedo" of albedo.R; that of
    // CryptoObject00.R is CryptoObject) in their order, named after it. Channels keep their names.
    bool parts = false;
};

struct ExrReport {
    std::uint64_t halfOverflows = 0;  // finite values beyond ±65504, written as ±65504
    std::uint64_t halfUnderflows = 0; // non-zero values that became 0
    std::vector<std::string> leftOut; // channels that an ACES container cannot hold
};

// Values of the channels `more` in the rows [y0, y1) of the data window, until the next call but one; from the top,
// whole rows, each once; one call at a time, from any thread. What R G B have there counts as soon as it returns.
using ExrRows = std::function<std::vector<std::span<const float>>(int y0, int y1)>;

// An ACES container holds R G B alone: other channels are left out and reported.
// The file appears under its name only when it is whole; on failure an older one is untouched. `rows`: where values of
// `more` come from, which are then empty in the picture; a multiple of kExrRows at a time, but for the last ones.
// Throws IoError, and what `rows` throws.
ExrReport writeExr(const std::string& path, const ExrPicture&, const ExrRows& rows = {});
inline constexpr int kExrRows = 16;

// Adds channels to an OpenEXR file that exists.
// Writes a copy of `source` to `target`, which may be the same file, with more channels and attributes in its first
// part; those of the same names are replaced. Everything else keeps its bits: a compression that loses some (pxr24,
// b44, dwa) becomes zip in that part, tiles become scan lines, and a file that was an ACES container, which may not
// have such channels, is none any more. Other parts are copied as they are. Channels are float and cover the data
// window of the first part. The file appears under its name only when it is whole. Throws IoError.
void appendExr(const std::string& source, const std::string& target, std::span<const ExrChannel> channels,
               std::span<const ImageAttribute> attributes);

} // namespace abbe
