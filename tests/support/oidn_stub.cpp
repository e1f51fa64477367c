// Stands for Open Image Denoise in tests: its C interface without any network. $OIDN_STUB says what it does:
//   (nothing)   the output is the input
//   blur        the mean of 3 × 3 pixels, the same for light and features
//   spill       as the first, but light of 60 in the rows 20 to 29
//   old         says that it is version 1.4.3
//   no-device   has no device
//   commit      committing a filter fails
//   memory      executing one finds too little memory
//   unsupported so does committing a device, for the processor
//   nan         a pixel of the output is not a number
// What a caller of the real one may not do is an error: other sizes, a filter that was not committed, normals beside no
// albedo, light below 0, albedo or normals beyond 1. $OIDN_STUB_LOG is a file that gets a line for each execution.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

struct Device {
    std::map<std::string, int> settings;
    bool committed = false;
};

struct Image {
    float* pixels = nullptr;
    std::size_t width = 0, height = 0;

    std::size_t size() const { return 3 * width * height; }
};

struct Filter {
    std::map<std::string, Image> images;
    std::map<std::string, float> settings;
    bool committed = false;
};

enum Error { none = 0, invalidArgument = 2, invalidOperation = 3, outOfMemory = 4, unsupportedHardware = 5 };

thread_local int pending = none;
thread_local std::string message;

void raise(Error error, const char* text) {
    if (pending != none) return; // the first one counts
    pending = error;
    message = text;
}

std::string mode() {
    const char* const value = std::getenv("OIDN_STUB");
    return value ? value : "";
}

bool within(const Image& image, float least, float most) {
    return std::all_of(image.pixels, image.pixels + image.size(), [&](float v) { return v >= least && v <= most; });
}

void checkInputs(const Filter& filter) {
    const auto find = [&](const char* name) {
        const auto found = filter.images.find(name);
        return found == filter.images.end() ? nullptr : &found->second;
    };
    const Image *colour = find("color"), *albedo = find("albedo"), *normal = find("normal"), *output = find("output");
    if (!output || (!colour && !albedo && !normal)) return raise(invalidOperation, "image not specified");
    for (const auto& [name, image] : filter.images)
        if (image.width != output->width || image.height != output->height)
            raise(invalidOperation, "image size mismatch");
    if (colour && normal && !albedo) raise(invalidOperation, "unsupported combination of input features");
    if (!colour && albedo && normal) raise(invalidOperation, "unsupported combination of input features");
    if (colour && !within(*colour, 0, INFINITY)) raise(invalidArgument, "light below 0");
    if (albedo && !within(*albedo, 0, 1)) raise(invalidArgument, "albedo beyond 1");
    if (normal && !within(*normal, -1, 1)) raise(invalidArgument, "normal beyond 1");
    if (colour && filter.settings.count("hdr") == 0) raise(invalidArgument, "light without hdr");
}

void blur(const Image& from, const Image& to) {
    const int width = static_cast<int>(from.width), height = static_cast<int>(from.height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                float sum = 0;
                for (int v = y - 1; v <= y + 1; ++v)
                    for (int u = x - 1; u <= x + 1; ++u)
                        sum +=
                            from.pixels[3 * (std::clamp(v, 0, height - 1) * width + std::clamp(u, 0, width - 1)) + c];
                to.pixels[3 * (y * width + x) + c] = sum / 9;
            }
}

void log(const Filter& filter) {
    const char* const path = std::getenv("OIDN_STUB_LOG");
    if (!path) return;
    std::ofstream out(path, std::ios::app);
    for (const auto& [name, image] : filter.images) out << name << ' ' << image.width << 'x' << image.height << ' ';
    for (const auto& [name, value] : filter.settings) out << name << '=' << value << ' ';
    out << '\n';
}

} // namespace

extern "C" {

void* oidnNewDevice(int type) {
    if (type == 1 && mode() != "no-device") return new Device;
    raise(unsupportedHardware, "unsupported device type: CPU");
    return nullptr;
}
void oidnReleaseDevice(void* device) { delete static_cast<Device*>(device); }
void oidnSetDeviceInt(void* device, const char* name, int value) {
    static_cast<Device*>(device)->settings[name] = value;
}
void oidnSetDeviceBool(void* device, const char* name, bool value) {
    static_cast<Device*>(device)->settings[name] = value;
}
int oidnGetDeviceInt(void*, const char* name) {
    if (std::string(name) != "version") return 0;
    return mode() == "old" ? 10403 : 20509;
}
void oidnCommitDevice(void* device) {
    static_cast<Device*>(device)->committed = true;
    if (mode() == "unsupported") raise(unsupportedHardware, "SSE4.1 support is required at minimum");
}
int oidnGetDeviceError(void*, const char** text) {
    static thread_local std::string kept;
    kept = message;
    if (text) *text = pending == none ? nullptr : kept.c_str();
    const int error = pending;
    pending = none;
    return error;
}
void* oidnNewFilter(void* device, const char* type) {
    if (!static_cast<Device*>(device)->committed) raise(invalidOperation, "changes to the device are not committed");
    if (std::string(type) != "RT") raise(invalidArgument, "unknown filter type");
    return new Filter;
}
void oidnReleaseFilter(void* filter) { delete static_cast<Filter*>(filter); }
void oidnSetSharedFilterImage(void* filter, const char* name, void* pixels, int format, std::size_t width,
                              std::size_t height, std::size_t, std::size_t, std::size_t) {
    if (format != 3) raise(invalidArgument, "unsupported image format");
    static_cast<Filter*>(filter)->images[name] = {static_cast<float*>(pixels), width, height};
}
void oidnSetFilterBool(void* filter, const char* name, bool value) {
    static_cast<Filter*>(filter)->settings[name] = value ? 1 : 0;
}
void oidnSetFilterInt(void* filter, const char* name, int value) {
    static_cast<Filter*>(filter)->settings[name] = static_cast<float>(value);
}
void oidnSetFilterFloat(void* filter, const char* name, float value) {
    static_cast<Filter*>(filter)->settings[name] = value;
}
void oidnCommitFilter(void* filter) {
    auto& f = *static_cast<Filter*>(filter);
    f.committed = true;
    checkInputs(f);
    if (mode() == "commit") raise(invalidOperation, "the filter does not like it");
}
void oidnExecuteFilter(void* filter) {
    auto& f = *static_cast<Filter*>(filter);
    if (!f.committed) raise(invalidOperation, "changes to the filter are not committed");
    if (mode() == "memory") raise(outOfMemory, "out of memory");
    if (pending != none) return;
    log(f);
    const Image& output = f.images["output"];
    const char* const main = f.images.count("color") ? "color" : f.images.count("albedo") ? "albedo" : "normal";
    const Image& input = f.images[main];
    if (mode() == "blur")
        blur(input, output);
    else
        std::copy_n(input.pixels, input.size(), output.pixels);
    if (mode() == "spill" && main == std::string("color"))
        std::fill_n(output.pixels + 60 * output.width, 30 * output.width, 60.f);
    if (mode() == "nan") output.pixels[output.size() / 2] = NAN;
}
}
