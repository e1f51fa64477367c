#include "base/regular_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace abbe {

RegularFile::RegularFile(const std::string& path) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0)
        why_ = std::strerror(errno);
    else if (S_ISDIR(status.st_mode))
        why_ = std::strerror(EISDIR);
    else if (!S_ISREG(status.st_mode))
        why_ = "it is not a regular file";
    else
        size_ = static_cast<std::uint64_t>(status.st_size);
}

RegularFile::~RegularFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::size_t RegularFile::readAt(std::uint64_t offset, std::span<char> to) {
    if (!good() || offset >= size_) return 0;
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), size_ - offset));
    std::size_t done = 0;
    while (done < wanted) {
        const ssize_t got = ::pread(descriptor_, to.data() + done, std::min<std::size_t>(wanted - done, 1u << 30),
                                    static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) why_ = std::strerror(errno);
        if (got <= 0) break; // or it was made shorter meanwhile
        done += static_cast<std::size_t>(got);
    }
    return done;
}

std::string RegularFile::readAll() {
    std::string bytes(size_, '\0');
    bytes.resize(readAt(0, bytes));
    return bytes;
}

} // namespace abbe
