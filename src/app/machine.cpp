#include "app/machine.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace abbe {

std::string processorName() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (const auto colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos)
            return line.substr(colon + 2);
    return {};
}

double physicalMemory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

namespace {

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

} // namespace

double availableMemory() { return std::min(physicalMemory(), groupLimit()); }

std::uint64_t residentMemory() {
    std::uint64_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t peakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

} // namespace abbe
