#include "base/memory_limit.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <sys/resource.h>
#include <unistd.h>

namespace abbe {

namespace {

std::atomic<double> limitSet{0}; // bytes; 0: nothing was set

// The limits of version 2 of control groups, from the own one up to the root, or of version 1; none: "max".
double groupLimit() {
    double least = std::numeric_limits<double>::infinity();
    const auto take = [&](const std::filesystem::path& file) {
        double bytes = 0;
        if (std::ifstream(file) >> bytes && bytes > 0) least = std::min(least, bytes);
    };
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const std::string path = line.substr(std::min(line.size(), line.rfind(':') + 1));
        if (line.starts_with("0::"))
            for (std::filesystem::path at(path);; at = at.parent_path()) {
                take("/sys/fs/cgroup" + at.string() + "/memory.max");
                if (!at.has_relative_path()) break;
            }
        if (line.find(":memory:") != std::string::npos) take("/sys/fs/cgroup/memory" + path + "/memory.limit_in_bytes");
    }
    take("/sys/fs/cgroup/memory.max"); // as a container sees its own
    take("/sys/fs/cgroup/memory/memory.limit_in_bytes");
    return least;
}

// Of `ulimit -v` and `ulimit -d`.
double processLimit() {
    double least = std::numeric_limits<double>::infinity();
    for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
        rlimit limit{};
        if (::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
            least = std::min(least, static_cast<double>(limit.rlim_cur));
    }
    return least;
}

} // namespace

double physicalMemory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double availableMemory() {
    static const double available = std::min({physicalMemory(), groupLimit(), processLimit()});
    return available;
}

std::uint64_t residentMemory() {
    std::uint64_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

double memoryLimit() {
    const double set = limitSet;
    return set > 0 ? set : availableMemory();
}

void setMemoryLimit(double bytes) { limitSet = bytes; }

double memoryLeft() { return std::max(0.0, memoryLimit() - static_cast<double>(residentMemory())); }

MemoryLimitExceeded::MemoryLimitExceeded(double bytes)
    : text_(fmt::format("it takes {} of memory; {} are left of {}", memoryText(bytes), memoryText(memoryLeft()),
                        memoryText(memoryLimit()))) {}

void requireMemory(double bytes) {
    constexpr double kNever = 1 << 20; // not worth a look
    if (bytes > kNever && bytes > memoryLeft()) throw MemoryLimitExceeded(bytes);
}

std::string memoryText(double bytes) {
    constexpr double kMebibyte = 1 << 20;
    return bytes < 1024 * kMebibyte ? fmt::format("{:.0f} MiB", bytes / kMebibyte)
                                    : fmt::format("{:.2f} GiB", bytes / kMebibyte / 1024);
}

std::string memoryReason(const std::bad_alloc& e) {
    return dynamic_cast<const MemoryLimitExceeded*>(&e) ? e.what() : "it needs more memory than there is";
}

} // namespace abbe
