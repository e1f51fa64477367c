#include "textures/image_file.h"

#include "base/memory_limit.h"
#include "base/program_folder.h"
#include "io/exr_reader.h"

#include <dlfcn.h>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace abbe {

namespace {

constexpr const char* kModule = "abbe_images.so";

// Beside the program, beside the folder of the tests, or where `cmake --install` puts it.
std::filesystem::path findModule() {
    std::error_code error;
    const auto program = programFolder();
    for (const char* folder : {".", "..", "../lib/abbe"}) {
        auto path = program / folder / kModule;
        if (std::filesystem::exists(path, error)) return path;
    }
    throw ImageFileError(fmt::format("image textures need the module `{}`, which is not beside the program in {}",
                                     kModule, program.string()));
}

const AbbeImageModule* loadModule() {
    // Never closed: its libraries hold threads of their own. A second call finds it loaded.
    void* const module = dlopen(findModule().c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!module) throw ImageFileError(fmt::format("the module for image textures cannot be loaded: {}", dlerror()));
    const auto get = reinterpret_cast<AbbeGetImageModule>(dlsym(module, kAbbeGetImageModule));
    if (!get || get()->version != kAbbeImageModuleVersion)
        throw ImageFileError("the module for image textures is of another version than the program");
    return get();
}

struct Reading {
    ImagePixels image;
    AbbeImageFault fault{};
    std::exception_ptr beyondMemory;
};

// What can be told without a library, which may not be given devices, nor OpenEXR what its header promises in vain.
void checkPicture(const std::string& path) {
    if (std::string reason = exrBoundsFault(path); !reason.empty()) throw ImageFileError(reason);
}

float* begin(void* user, int width, int height, int channels, const char* colorSpace) {
    auto& reading = *static_cast<Reading*>(user);
    try {
        ImagePixels& image = reading.image;
        image.width = width;
        image.height = height;
        image.channels = channels;
        image.colorSpace = colorSpace;
        const auto count =
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
        requireMemory(2.0 * static_cast<double>(count) * sizeof(float)); // and as it is stored
        image.values.resize(count);
        return image.values.data();
    } catch (const std::exception&) { // must not cross the interface
        reading.beyondMemory = std::current_exception();
        return nullptr;
    }
}

void fail(void* user, const AbbeImageFault* fault) { static_cast<Reading*>(user)->fault = *fault; }

} // namespace

const AbbeImageModule& imageModule() {
    static const AbbeImageModule* const module = loadModule();
    return *module;
}

ImagePixels readImageFile(const std::string& path, int first, int mostChannels) {
    checkPicture(path);
    Reading reading;
    const AbbeImageSink sink{&reading, begin, fail};
    const bool good = imageModule().read(path.c_str(), first, mostChannels, &sink);
    if (reading.beyondMemory) std::rethrow_exception(reading.beyondMemory);
    if (!good && reading.fault.kind == abbeFaultOfMemory) throw std::bad_alloc();
    if (!good) throw ImageFileError(reading.fault.reason[0] ? reading.fault.reason : "it cannot be read");
    return std::move(reading.image);
}

AbbeImageInfo describeImageFile(const std::string& path) {
    checkPicture(path);
    AbbeImageInfo info{};
    AbbeImageFault fault{};
    if (!imageModule().describe(path.c_str(), &info, &fault)) throw ImageFileError(fault.reason);
    return info;
}

} // namespace abbe
