#include "geometry/embree_device.h"

#include "base/parallel.h"

#include <fmt/format.h>
#include <new>
#include <stdexcept>

namespace abbe {

namespace {

void remember(void* user, RTCError code, const char* text) {
    auto& first = *static_cast<std::string*>(user);
    if (first.empty()) first = fmt::format("Embree error {}: {}", static_cast<int>(code), text ? text : "no text");
}

#ifdef __SANITIZE_THREAD__
// Embree builds in TBB's threads, whose order the thread sanitizer does not see (base/parallel.cpp).
int buildThreads() { return 1; }
#else
int buildThreads() { return threadCount(); }
#endif

} // namespace

EmbreeDevice::EmbreeDevice()
    : firstError_(std::make_unique<std::string>()),
      device_(rtcNewDevice(fmt::format("threads={}", buildThreads()).c_str())) {
    if (!device_) {
        const RTCError error = rtcGetDeviceError(nullptr);
        if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        throw std::runtime_error(
            fmt::format("Embree cannot start on this machine (error {})", static_cast<int>(error)));
    }
    rtcSetDeviceErrorFunction(device_.get(), remember, firstError_.get());
}

void EmbreeDevice::throwIfFailed() const {
    if (!firstError_->empty()) throw std::runtime_error(*firstError_);
}

} // namespace abbe
