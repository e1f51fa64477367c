// OpenEXR input of pictures: R G B or grey.
#pragma once

#include "io/exr_channels.h"
#include "io/image.h"

#include <string>

namespace abbe {

// R G B, or Y alone for grey. Throws IoError for anything else, and for damaged files.
RgbImage readExr(const std::string& path);

} // namespace abbe
