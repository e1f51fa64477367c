#include "denoise/oidn_library.h"

#include "denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "libOpenImageDenoise.so.2";
constexpr const char* kHelp = "`pip install pyoidn` in a virtual environment that is active, or $ABBE_OIDN=PATH of the "
                              "library or of its folder; `--method nfor` is built in";

std::string variable(const char* name) {
    const char* const value = std::getenv(name);
    return value ? value : "";
}

// Loading runs code and may wait for what is no file, so nothing else is tried.
bool isLibraryFile(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error);
}

// The library in the packages of a Python of any version below `prefix`; the first by name.
std::optional<fs::path> inPython(const fs::path& prefix) {
    std::error_code error;
    std::vector<fs::path> found;
    for (fs::directory_iterator i(prefix / "lib", error), end; !error && i != end; i.increment(error)) {
        if (!i->path().filename().string().starts_with("python3")) continue;
        for (const char* packages : {"site-packages", "dist-packages"})
            if (fs::path file = i->path() / packages / "pyoidn/oidn/lib" / kFile; isLibraryFile(file))
                found.push_back(std::move(file));
    }
    if (found.empty()) return {};
    return *std::min_element(found.begin(), found.end());
}

std::optional<fs::path> inFolder(const fs::path& folder) {
    for (const char* below : {".", "lib", "lib64", "oidn/lib", "pyoidn/oidn/lib"})
        if (fs::path file = folder / below / kFile; isLibraryFile(file)) return file.lexically_normal();
    return inPython(folder);
}

// $ABBE_OIDN. What it names is meant: nothing else is taken in its place.
std::string namedLibrary(const std::string& where) {
    std::error_code error;
    const fs::path path = fs::absolute(where, error);
    if (isLibraryFile(path)) return path.string();
    if (const auto file = inFolder(path)) return file->string();
    throw DenoiserFault(
        "E0442",
        fmt::format("$ABBE_OIDN is `{}`: {}", where,
                    fs::is_directory(path, error) ? fmt::format("there is no {} in or below it", kFile)
                                                  : std::string("there is no such file or folder")),
        fmt::format("name the file `{}` of Open Image Denoise 2 or its folder; `--method nfor` is built in", kFile));
}

// Where the package is when the system has no library of its own; empty: nowhere.
std::string inPackages() {
    const std::string home = variable("HOME"), environment = variable("VIRTUAL_ENV");
    for (const std::string& prefix :
         {environment, home.empty() ? home : home + "/.local", std::string("/usr/local"), std::string("/usr")})
        if (!prefix.empty())
            if (const auto file = inPython(prefix)) return file->string();
    return {};
}

// Never closed: the library has threads of its own.
void* openLibrary(const std::string& path) { return dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE); }

std::string findLibrary() {
    if (const std::string where = variable("ABBE_OIDN"); !where.empty()) return namedLibrary(where);
    if (openLibrary(kFile)) return kFile;
    if (std::string path = inPackages(); !path.empty()) return path;
    throw DenoiserFault("E0442", fmt::format("Open Image Denoise is not there: no {} on this system", kFile), kHelp);
}

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw DenoiserFault("E0443", fmt::format("`{}` cannot be used: {}", path, why),
                        "Open Image Denoise 2 for this processor and system is needed, as in `pip install pyoidn`; "
                        "`--method nfor` is built in");
}

class Symbols {
  public:
    Symbols(void* library, const std::string& path) : library_(library), path_(path) {}
    template <typename F> void get(const char* name, F*& function) const {
        function = reinterpret_cast<F*>(dlsym(library_, name));
        if (!function) refuse(path_, fmt::format("it is not Open Image Denoise 2, as it has no `{}`", name));
    }

  private:
    void* library_;
    const std::string& path_;
};

} // namespace

OidnLibrary::OidnLibrary(std::string path) : path_(std::move(path)) {
    void* const library = openLibrary(path_);
    if (!library) refuse(path_, dlerror());
    const Symbols symbols(library, path_);
    symbols.get("oidnNewDevice", calls_.newDevice);
    symbols.get("oidnReleaseDevice", calls_.releaseDevice);
    symbols.get("oidnSetDeviceInt", calls_.setDeviceInt);
    symbols.get("oidnSetDeviceBool", calls_.setDeviceBool);
    symbols.get("oidnGetDeviceInt", calls_.getDeviceInt);
    symbols.get("oidnCommitDevice", calls_.commitDevice);
    symbols.get("oidnGetDeviceError", calls_.getDeviceError);
    symbols.get("oidnNewFilter", calls_.newFilter);
    symbols.get("oidnReleaseFilter", calls_.releaseFilter);
    symbols.get("oidnSetSharedFilterImage", calls_.setSharedFilterImage);
    symbols.get("oidnSetFilterBool", calls_.setFilterBool);
    symbols.get("oidnSetFilterInt", calls_.setFilterInt);
    symbols.get("oidnSetFilterFloat", calls_.setFilterFloat);
    symbols.get("oidnCommitFilter", calls_.commitFilter);
    symbols.get("oidnExecuteFilter", calls_.executeFilter);
    // Its version is that of a device.
    void* const device = calls_.newDevice(1);
    const char* message = nullptr;
    if (!device) {
        calls_.getDeviceError(nullptr, &message);
        refuse(path_, message ? message : "it has no device for the CPU");
    }
    version_ = calls_.getDeviceInt(device, "version");
    calls_.releaseDevice(device);
    if (version_ / 10000 != 2) refuse(path_, fmt::format("it is version {}, not 2", version()));
}

std::string OidnLibrary::version() const {
    return fmt::format("{}.{}.{}", version_ / 10000, version_ / 100 % 100, version_ % 100);
}

const OidnLibrary& OidnLibrary::get() {
    static std::mutex mutex;
    static std::map<std::string, std::unique_ptr<const OidnLibrary>> loaded;
    const std::lock_guard lock(mutex);
    std::string path = findLibrary();
    auto& library = loaded[path];
    if (!library) library.reset(new OidnLibrary(path));
    return *library;
}

namespace {

// Values of its enumerations.
constexpr int kCpu = 1, kFloat3 = 3, kOutOfMemory = 4, kUnsupportedHardware = 5;
constexpr int kFast = 4, kBalanced = 5, kHigh = 6;
constexpr int kHasFast = 20300; // the version that brought it

class Filter {
  public:
    Filter(const OidnInterface& calls, void* device) : calls_(calls), filter_(calls.newFilter(device, "RT")) {}
    ~Filter() {
        if (filter_) calls_.releaseFilter(filter_);
    }
    Filter(const Filter&) = delete;
    Filter& operator=(const Filter&) = delete;
    void* get() const { return filter_; }
    // Images are read only, but for the output.
    void set(const char* name, const OidnImage* image) const {
        if (!image) return;
        calls_.setSharedFilterImage(filter_, name, const_cast<float*>(image->values.data()), kFloat3,
                                    static_cast<std::size_t>(image->width), static_cast<std::size_t>(image->height), 0,
                                    0, 0);
    }

  private:
    const OidnInterface& calls_;
    void* filter_;
};

} // namespace

OidnDevice::OidnDevice(const OidnLibrary& library, int threads, int megabytes, bool fast)
    : library_(library), device_(library.calls().newDevice(kCpu)), megabytes_(megabytes), fast_(fast) {
    const OidnInterface& calls = library_.calls();
    if (device_) {
        calls.setDeviceInt(device_, "numThreads", threads);
        calls.setDeviceBool(device_, "setAffinity", false); // other programs, and other threads of this one, run too
        calls.commitDevice(device_);
    }
    try {
        check();
    } catch (...) {
        if (device_) calls.releaseDevice(device_);
        throw;
    }
}

OidnDevice::~OidnDevice() { library_.calls().releaseDevice(device_); }

void OidnDevice::check() const {
    const char* message = nullptr;
    const int error = library_.calls().getDeviceError(device_, &message);
    if (error == 0 && device_) return;
    std::string help = "`--method nfor` is built in";
    if (error == kOutOfMemory) help = "end other programs, or take `--method nfor`, which is built in";
    if (error == kUnsupportedHardware) help = "it needs a processor with SSE4.1; `--method nfor` is built in";
    throw DenoiserFault("E0444",
                        fmt::format("Open Image Denoise {} failed: {}", library_.version(),
                                    message && *message ? message : "it does not say why"),
                        std::move(help));
}

OidnImage OidnDevice::filter(const OidnImages& images) const {
    const OidnInterface& calls = library_.calls();
    const OidnImage& like = images.colour ? *images.colour : images.albedo ? *images.albedo : *images.normal;
    OidnImage result(like.width, like.height);
    const Filter filter(calls, device_);
    if (!filter.get()) check();
    filter.set("color", images.colour);
    filter.set("albedo", images.albedo);
    filter.set("normal", images.normal);
    filter.set("output", &result);
    if (images.colour) {
        calls.setFilterBool(filter.get(), "hdr", true);
        // Colours come scaled. What it would find out itself differs from half to half.
        calls.setFilterFloat(filter.get(), "inputScale", 1);
        if (images.cleanFeatures) calls.setFilterBool(filter.get(), "cleanAux", true);
    }
    const int fastest = library_.versionNumber() >= kHasFast ? kFast : kBalanced;
    calls.setFilterInt(filter.get(), "quality", fast_ ? fastest : kHigh);
    calls.setFilterInt(filter.get(), "maxMemoryMB", megabytes_);
    calls.commitFilter(filter.get());
    check();
    calls.executeFilter(filter.get());
    check();
    if (!std::all_of(result.values.begin(), result.values.end(), [](float v) { return std::isfinite(v); }))
        throw DenoiserFault("E0444",
                            fmt::format("Open Image Denoise {} made pixels that are not finite", library_.version()),
                            "`--method nfor` is built in");
    return result;
}

} // namespace abbe
