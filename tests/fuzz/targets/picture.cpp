// Textures of any format, through the module: header, whole picture, conversion to a texture.
#include "fuzz/target.h"
#include "spectrum/color_space.h"
#include "textures/texture_store.h"

#include <filesystem>
#include <new>
#include <unistd.h>

using namespace abbe;

namespace {

namespace fs = std::filesystem;

fs::path cacheFolder() {
    static const fs::path folder = fs::temp_directory_path() / ("abbe-fuzz-picture-" + std::to_string(::getpid()));
    return folder;
}

} // namespace

// OpenImageIO's readers lose the texts of some of their errors.
extern "C" const char* __lsan_default_suppressions() { return "leak:libOpenImageIO"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    imageModule(); // throws if it is not there
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    try {
        const AbbeImageInfo info = describeImageFile(file.path());
        const ImagePixels pixels = readImageFile(file.path());
        fuzz::require(pixels.width == info.width && pixels.height == info.height, "two sizes of one picture");
        textureFile(file.path(), info, *findColorEncoding("data"), cacheFolder(), nullptr);
    } catch (const ImageFileError&) {
    } catch (const std::bad_alloc&) {
    }
    std::error_code error;
    fs::remove_all(cacheFolder(), error);
    return 0;
}
