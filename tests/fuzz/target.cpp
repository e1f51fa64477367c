#include "fuzz/target.h"

#include <cstdio>
#include <cstdlib>
#include <sys/mman.h>
#include <unistd.h>

namespace abbe::fuzz {

MemoryFile::MemoryFile(std::string_view bytes) : descriptor_(::memfd_create("input", 0)) {
    require(descriptor_ >= 0, "no file in memory");
    while (!bytes.empty()) {
        const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
        require(done > 0, "no room for a file in memory");
        bytes.remove_prefix(static_cast<std::size_t>(done));
    }
    path_ = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(descriptor_);
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

void require(bool good, const char* what) {
    if (good) return;
    std::fprintf(stderr, "broken contract: %s\n", what);
    std::abort();
}

} // namespace abbe::fuzz
