// Open Image Denoise 2, which is no part of the program: found and loaded when it is first asked for, without its
// headers. A device of it, and one filter at work on it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace abbe {

// What is used of its C interface, as its documentation declares it. Enumerations are ints, handles are opaque.
struct OidnInterface {
    void* (*newDevice)(int type);
    void (*releaseDevice)(void* device);
    void (*setDeviceInt)(void* device, const char* name, int value);
    void (*setDeviceBool)(void* device, const char* name, bool value);
    int (*getDeviceInt)(void* device, const char* name);
    void (*commitDevice)(void* device);
    // The first error since the last call, whose text lives until the next one. 0: none.
    int (*getDeviceError)(void* device, const char** message);
    void* (*newFilter)(void* device, const char* type);
    void (*releaseFilter)(void* filter);
    void (*setSharedFilterImage)(void* filter, const char* name, void* pixels, int format, std::size_t width,
                                 std::size_t height, std::size_t byteOffset, std::size_t pixelByteStride,
                                 std::size_t rowByteStride);
    void (*setFilterBool)(void* filter, const char* name, bool value);
    void (*setFilterInt)(void* filter, const char* name, int value);
    void (*setFilterFloat)(void* filter, const char* name, float value);
    void (*commitFilter)(void* filter);
    void (*executeFilter)(void* filter);
};

class OidnLibrary {
  public:
    // Looks at $ABBE_OIDN, which is the library or a folder with it, or with an environment of Python; without it,
    // where the system has its libraries, and then in the package `pyoidn` of $VIRTUAL_ENV, of the user and of the
    // system. A library is loaded once and stays until the process ends. Any thread. Throws DenoiserFault: E0442 where
    // there is none, E0443 where it cannot be used.
    static const OidnLibrary& get();

    const OidnInterface& calls() const { return calls_; }
    const std::string& path() const { return path_; }
    std::string version() const;                   // "2.5.1"
    int versionNumber() const { return version_; } // 20501

  private:
    explicit OidnLibrary(std::string path);

    std::string path_;
    OidnInterface calls_{};
    int version_ = 0;
};

// R G B of each pixel, row by row.
struct OidnImage {
    int width = 0, height = 0;
    std::vector<float> values;

    OidnImage() = default;
    OidnImage(int w, int h)
        : width(w), height(h), values(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
};

// What a run of the filter reads; null: not there.
struct OidnImages {
    const OidnImage *colour = nullptr, *albedo = nullptr, *normal = nullptr;
    bool cleanFeatures = false;
};

// A device on the CPU with as many threads as the process may have. Throws DenoiserFault (E0444) wherever the library
// says that something went wrong.
class OidnDevice {
  public:
    // `megabytes`: what its filters take at most for themselves, roughly.
    OidnDevice(const OidnLibrary&, int threads, int megabytes, bool fast);
    ~OidnDevice();
    OidnDevice(const OidnDevice&) = delete;
    OidnDevice& operator=(const OidnDevice&) = delete;

    // The colours without noise, or of features alone these. All images have one size.
    OidnImage filter(const OidnImages&) const;

  private:
    void check() const;

    const OidnLibrary& library_;
    void* device_ = nullptr;
    int megabytes_;
    bool fast_;
};

} // namespace abbe
