// Layers of an image as pictures to look at. docs/output.md says what is shown how.
#pragma once

#include "io/exr_reader.h"

#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// What stands before the last dot of channel names, in the order of the file, each once.
std::vector<std::string> layerNames(const ExrInfo&);

// A layer's numbers, interleaved RGB of the data window.
struct LayerPicture {
    std::vector<float> rgb;
    bool colours = false; // linear light in the image's space, for a view; else what a display shall show, 0 to 1
};

// Of a layer, or of one channel by its whole name. `gain` scales what is shown as grey. Requires channels of that name:
// nothing if there are none. Throws IoError.
std::optional<LayerPicture> layerPicture(const std::string& path, const ExrInfo&, std::string_view name, float gain);
// The same of channels that are in memory.
std::optional<LayerPicture> layerPicture(const ExrPlanes&, std::string_view name, float gain);

} // namespace abbe
