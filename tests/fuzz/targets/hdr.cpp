// Radiance pictures.
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "io/image.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    fuzz::reading([&] {
        const RgbImage image = readHdr(file.path());
        fuzz::require(image.rgb.size() == 3 * image.window.area(), "a picture of another size");
    });
    return 0;
}
