// Photometric files.
#include "io/ies.h"

#include "fuzz/target.h"
#include "io/file.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const IntensityTable t = parseIes(fuzz::bytesOf(data, size), "fuzz.ies");
        fuzz::require(t.candela.size() == t.vertical.size() * t.horizontal.size(), "intensities of other angles");
        for (const double v : t.candela) fuzz::require(v >= 0, "an intensity below 0");
    } catch (const IoError&) {
    }
    return 0;
}
