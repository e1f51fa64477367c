// OpenEXR input: what a file promises, the facts in its header, channels by their names, and pictures.
#pragma once

#include "io/exr_writer.h"
#include "io/image.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// Of the first part; the channels are those of all parts that are no deep image and have its data window. Channels of
// later parts without a layer in their name ("R") are named after the part ("left.R"); of equal names the first counts.
struct ExrInfo {
    struct Channel {
        std::string name;
        std::string type; // "half", "float", "uint"
        int part = 0;
    };
    PixelWindow window, display;
    std::vector<Channel> channels;
    std::string compression; // as in ExrCompression, or what the file says
    std::optional<Chromaticities> chromaticities;
    std::optional<Chromaticity> adoptedNeutral;
    bool acesContainer = false; // as the file claims: see io/aces_container.h
    int parts = 1;
    bool deep = false;                      // the first part has several samples per pixel, each at a depth
    std::vector<ImageAttribute> attributes; // the ones of types text, int, float and double

    bool has(std::string_view channel) const;
    std::string channelNames() const; // with spaces between them
};
// Reads the header alone. Throws IoError.
ExrInfo readExrInfo(const std::string& path);

// Channels, each a plane of the data window, row by row from the top.
struct ExrPlanes {
    ExrInfo info;
    std::vector<std::vector<float>> values; // one for each of info.channels, empty for those that were not wanted

    // The values of a channel, or null if the file has none of that name or it was not wanted.
    const std::vector<float>* find(std::string_view name) const;
};

// Reads every channel that `wanted` accepts, by default all; scan lines or tiles. Halves and floats keep their bits
// (NaN payloads of halves aside); integers are rounded to float, exactly below 2²⁴. Throws IoError for files that are
// damaged, too large, deep, or have a wanted channel at a lower resolution than the picture.
ExrPlanes readExrChannels(const std::string& path, const std::function<bool(std::string_view name)>& wanted = nullptr);

// One channel by its name. Throws IoError, also when there is none.
std::vector<float> readExrChannel(const std::string& path, const std::string& channel);

// R G B, or Y alone for grey. Throws IoError for anything else, and for damaged files.
RgbImage readExr(const std::string& path);

// What an OpenEXR file promises, held against its bytes before OpenEXR looks at it.

// Empty, or why the file cannot be what its header says: no pixels or too many (image.h), parts, channels or tiles
// beyond reason, more chunks than it has bytes for, or more pixels than its compression can make of its bytes. Looks at
// the header alone, so the time does not depend on what is promised there. Of a file of another kind: empty.
std::string exrBoundsFault(const std::string& path);

// The most bytes that a compression, by its number in OpenEXR, makes of one.
double exrMostExpansion(int compression);

// Throws IoError with that reason.
void checkExrBounds(const std::string& path);

} // namespace abbe
