// What an OpenEXR file promises, held against its bytes before OpenEXR looks at it.
#pragma once

#include <cstdint>
#include <string>

namespace abbe {

// Empty, or why the file cannot be what its header says: no pixels or too many (image.h), parts, channels or tiles
// beyond reason, more chunks than it has bytes for, or more pixels than its compression can make of its bytes. Looks at
// the header alone, so the time does not depend on what is promised there. Of a file of another kind: empty.
std::string exrBoundsFault(const std::string& path);

// The most bytes that a compression, by its number in OpenEXR, makes of one.
double exrMostExpansion(int compression);

// Throws IoError with that reason.
void checkExrBounds(const std::string& path);

} // namespace abbe
