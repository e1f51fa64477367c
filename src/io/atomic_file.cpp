#include "io/atomic_file.h"

#include "io/io_error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace abbe {

namespace {

// The file that a chain of links ends at, whether or not it exists.
std::string resolveLinks(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_symlink(path, error)) return path;
    const auto resolved = std::filesystem::weakly_canonical(path, error);
    return error ? path : resolved.string();
}

// Best effort: a rename is on disk once its folder is; some file systems cannot sync folders.
void syncFolder(const std::string& file) {
    const auto folder = std::filesystem::path(file).parent_path();
    const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

} // namespace

AtomicFile::AtomicFile(const std::string& path)
    : path_(path), target_(resolveLinks(path)), temporary_(target_ + ".tmp") {
    struct stat status {};
    if (::stat(target_.c_str(), &status) == 0) {
        if (S_ISDIR(status.st_mode)) fail(EISDIR);
        if (!S_ISREG(status.st_mode))
            throw IoError(fmt::format("cannot write `{}`: it exists and is not a regular file", path_));
        if (::access(target_.c_str(), W_OK) != 0) fail(errno); // renaming would replace a write-protected file
    }
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail(errno);
}

AtomicFile::~AtomicFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
}

void AtomicFile::fail(int error) const {
    throw IoError(fmt::format("cannot write `{}`: {}", path_, std::strerror(error)));
}

void AtomicFile::write(std::span<const char> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(position_));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail(written < 0 ? errno : ENOSPC);
        position_ += static_cast<std::uint64_t>(written);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void AtomicFile::seek(std::uint64_t position) { position_ = position; }

void AtomicFile::commit() {
    if (::fsync(descriptor_) != 0) fail(errno);
    const int descriptor = descriptor_;
    descriptor_ = -1;
    int error = ::close(descriptor) == 0 ? 0 : errno; // network file systems report lost data here
    if (error == 0 && ::rename(temporary_.c_str(), target_.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary_.c_str());
        fail(error);
    }
    syncFolder(target_);
}

void writeAtomically(const std::string& path, std::span<const char> bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

} // namespace abbe
