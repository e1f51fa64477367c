// Radiance .hdr (RGBE) input.
#pragma once

#include "io/image.h"

#include <string>

namespace abbe {

// Values are mantissa · 2^exponent as stored (no half step added, like nearly all writers and readers), divided by the
// EXPOSURE and COLORCORR of the header, which gives back what was there before them, as the format asks. PRIMARIES
// become the chromaticities. Rows in either order and columns in either order; XYZE and columns-first are refused.
// Throws IoError for damaged and truncated files.
RgbImage readHdr(const std::string& path);

} // namespace abbe
