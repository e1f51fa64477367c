// Ownership of Embree's reference-counted handles, and its errors as exceptions.
#pragma once

#include <embree3/rtcore.h>
#include <memory>
#include <string>
#include <type_traits>

namespace abbe {

// A unique_ptr for an Embree handle: EmbreeHandle<RTCScene, rtcReleaseScene>.
template <typename Handle, void (*release)(Handle)> struct EmbreeRelease {
    using pointer = Handle;
    void operator()(Handle h) const { release(h); }
};
template <typename Handle, void (*release)(Handle)>
using EmbreeHandle = std::unique_ptr<std::remove_pointer_t<Handle>, EmbreeRelease<Handle, release>>;

// One device of Embree with threadCount() threads for building. Throws std::runtime_error if there can be none.
class EmbreeDevice {
  public:
    EmbreeDevice();
    RTCDevice get() const { return device_.get(); }
    // Throws std::runtime_error with the first error that Embree reported since the device was made.
    void throwIfFailed() const;

  private:
    std::unique_ptr<std::string> firstError_; // a stable address for the callback
    EmbreeHandle<RTCDevice, rtcReleaseDevice> device_;
};

} // namespace abbe
