// Adds channels to an OpenEXR file that exists.
#pragma once

#include "io/exr_writer.h"

#include <span>
#include <string>

namespace abbe {

// Writes a copy of `source` to `target`, which may be the same file, with more channels and attributes in its first
// part; those of the same names are replaced. Everything else keeps its bits: a compression that loses some (pxr24,
// b44, dwa) becomes zip in that part, tiles become scan lines, and a file that was an ACES container, which may not
// have such channels, is none any more. Other parts are copied as they are. Channels are float and cover the data
// window of the first part. The file appears under its name only when it is whole. Throws IoError.
void appendExr(const std::string& source, const std::string& target, std::span<const ExrChannel> channels,
               std::span<const ImageAttribute> attributes);

} // namespace abbe
