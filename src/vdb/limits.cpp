#include "vdb/commands.h"

#include <algorithm>
#include <sys/resource.h>
#include <sys/stat.h>

namespace abbe::vdb {

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true; // reserves terabytes of addresses
#else
constexpr bool kSanitized = false;
#endif

void limit(int resource, rlim_t value) {
    rlimit now{};
    if (::getrlimit(static_cast<__rlimit_resource>(resource), &now) != 0) return;
    if (now.rlim_max != RLIM_INFINITY && value > now.rlim_max) value = now.rlim_max;
    now.rlim_cur = value;
    ::setrlimit(static_cast<__rlimit_resource>(resource), &now);
}

} // namespace

void setLimits(const std::string& file, std::uint64_t memory) {
    limit(RLIMIT_CORE, 0);
    struct stat status {};
    const bool known = ::stat(file.c_str(), &status) == 0;
    const auto size = static_cast<rlim_t>(known ? status.st_size : 0);
    limit(RLIMIT_CPU, known ? 8 + size / 250'000 : 7200);
    if (kSanitized) return;
    limit(RLIMIT_DATA, known ? std::min<rlim_t>(memory, 2'000'000'000 + 256 * size) : memory);
}

} // namespace abbe::vdb
