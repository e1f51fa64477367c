// Radiance pictures.
#include "fuzz/target.h"
#include "io/hdr_reader.h"
#include "io/io_error.h"

#include <new>

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    try {
        const RgbImage image = readHdr(file.path());
        fuzz::require(image.rgb.size() == 3 * image.window.area(), "a picture of another size");
    } catch (const IoError&) {
    } catch (const std::bad_alloc&) {
    }
    return 0;
}
