// OpenEXR input: pictures, single channels and the facts in the header.
#pragma once

#include "io/exr_writer.h"
#include "io/image.h"

#include <string>
#include <vector>

namespace abbe {

// R G B, or Y alone for grey. Throws IoError for anything else, and for damaged files.
RgbImage readExr(const std::string& path);

// One channel by its name, over the data window. Throws IoError.
std::vector<float> readExrChannel(const std::string& path, const std::string& channel);

struct ExrInfo {
    struct Channel {
        std::string name;
        std::string type; // "half", "float", "uint"
    };
    PixelWindow window, display;
    std::vector<Channel> channels;
    std::string compression; // as in ExrCompression, or what the file says
    std::optional<Chromaticities> chromaticities;
    bool acesContainer = false;
    int parts = 1;                          // only the first one is described
    std::vector<ImageAttribute> attributes; // the ones of types text, int, float and double
};
// Reads the header alone. Throws IoError.
ExrInfo readExrInfo(const std::string& path);

} // namespace abbe
