// Whether a file is an ACES image container [SMPTE2065-4].
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abbe {

struct AcesVerdict {
    bool claimed = false;            // the file has an `acesImageContainerFlag`
    std::vector<std::string> faults; // rules that are broken, one phrase each
    bool valid() const { return faults.empty(); }
};

// Reads the bytes of a whole file by itself, without the library that wrote them: magic number and version, header,
// required and predefined attributes, channels, colour, line offsets and scan lines. What the standard leaves free is
// not judged: other attributes, the pixels' values.
AcesVerdict checkAcesContainer(std::string_view bytes);

} // namespace abbe
