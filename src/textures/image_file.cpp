#include "textures/image_file.h"

#include "base/memory_limit.h"
#include "base/named_arrays.h"
#include "base/program_folder.h"
#include "io/exr_reader.h"

#include <algorithm>
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

AbbeImageInfo infoOf(const AbbePixels& p) {
    AbbeImageInfo info{};
    info.width = p.width;
    info.height = p.height;
    info.channels = p.channels >= 3 ? 3 : 1;
    info.alpha = p.channels % 2 == 0 ? p.channels - 1 : -1;
    info.type = p.type;
    return info;
}

float valueOf(const AbbePixels& p, std::size_t at) {
    if (p.type == abbeTexelFloat) return static_cast<const float*>(p.values)[at];
    return static_cast<float>(static_cast<const std::uint8_t*>(p.values)[at]) * (1.0f / 255);
}

ImagePixels imageOf(const AbbePixels& p, int first, int mostChannels) {
    ImagePixels image;
    image.width = p.width;
    image.height = p.height;
    image.channels = std::min(p.channels - first, mostChannels) >= 3 ? 3 : 1;
    const auto all = static_cast<std::size_t>(p.channels), used = static_cast<std::size_t>(image.channels);
    const std::size_t texels = static_cast<std::size_t>(p.width) * static_cast<std::size_t>(p.height);
    requireMemory(static_cast<double>(texels * used) * sizeof(float));
    image.values.resize(texels * used);
    for (std::size_t i = 0; i < texels; ++i)
        for (std::size_t c = 0; c < used; ++c)
            image.values[i * used + c] = valueOf(p, i * all + static_cast<std::size_t>(first) + c);
    return image;
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

std::optional<MemoryPicture> pixelsInMemory(const std::string& path) {
    const auto arrays = findArrays(path);
    if (!arrays) return std::nullopt;
    const auto [width, height, channels] = arrays->size;
    const auto bytes = arrays->bytes.find("pixels");
    const bool integers = bytes != arrays->bytes.end();
    const std::size_t given = integers ? bytes->second.size() : arrays->of("pixels").size();
    if (width < 1 || height < 1 || channels < 1 || channels > 4 ||
        given !=
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels))
        throw ImageFileError(fmt::format("{} numbers are no picture of {} × {} pixels with {} channels", given, width,
                                         height, channels));
    const void* values = arrays->of("pixels").data();
    if (integers) values = bytes->second.data();
    return MemoryPicture{{width, height, channels, integers ? abbeTexel8 : abbeTexelFloat, values}, arrays};
}

ImagePixels readImageFile(const std::string& path, int first, int mostChannels) {
    if (const auto pixels = pixelsInMemory(path)) return imageOf(pixels->pixels, first, mostChannels);
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
    if (const auto pixels = pixelsInMemory(path)) return infoOf(pixels->pixels);
    checkPicture(path);
    AbbeImageInfo info{};
    AbbeImageFault fault{};
    if (!imageModule().describe(path.c_str(), &info, &fault)) throw ImageFileError(fault.reason);
    return info;
}

} // namespace abbe
