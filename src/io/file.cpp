#include "io/file.h"

#include "base/file.h"
#include "base/memory_limit.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace abbe {

std::string readFileBytes(const std::string& path) {
    RegularFile file(path);
    requireMemory(static_cast<double>(file.size()));
    std::string bytes = file.readAll();
    if (!file.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file.why()));
    return bytes;
}

LargeFile::LargeFile(const std::string& path) {
    RegularFile file(path);
    requireMemory(static_cast<double>(file.size()));
    bytes_ = std::make_unique_for_overwrite<char[]>(file.size());
    size_ = file.readAt(0, {bytes_.get(), file.size()});
    if (!file.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file.why()));
}

namespace {

constexpr std::size_t kMostWaiting = 1 << 16;
// So much is sent to the disk while more is made, so that commit() waits for little.
constexpr std::uint64_t kSentAtOnce = std::uint64_t{32} << 20;

// In a folder where everybody may make files, a link may have been put in the way of what is written there. The rule is
// that of Linux for opening files (protected_symlinks), which renaming does not have.
bool isPlanted(const std::string& link) {
    const auto folder = std::filesystem::path(link).parent_path();
    struct stat own {
    }, around{};
    if (::lstat(link.c_str(), &own) != 0 || ::stat(folder.empty() ? "." : folder.c_str(), &around) != 0) return true;
    const bool forEverybody = (around.st_mode & S_ISVTX) && (around.st_mode & S_IWOTH);
    return forEverybody && own.st_uid != ::geteuid() && own.st_uid != around.st_uid;
}

// The file that a chain of links ends at, whether or not it exists.
std::string resolveLinks(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_symlink(path, error)) return path;
    if (isPlanted(path))
        throw IoError(fmt::format("cannot write `{}`: it is a link of another user in a folder for everybody", path));
    const auto resolved = std::filesystem::weakly_canonical(path, error);
    return error ? path : resolved.string();
}

[[noreturn]] void failToWrite(const std::string& path, int error) {
    throw IoError(fmt::format("cannot write `{}`: {}", path, std::strerror(error)));
}

std::string writableTarget(const std::string& path) {
    std::string target = resolveLinks(path);
    struct stat status {};
    if (::stat(target.c_str(), &status) != 0) return target;
    if (S_ISDIR(status.st_mode)) failToWrite(path, EISDIR);
    if (!S_ISREG(status.st_mode))
        throw IoError(fmt::format("cannot write `{}`: it exists and is not a regular file", path));
    // Renaming would replace a write-protected file.
    if (::access(target.c_str(), W_OK) != 0) failToWrite(path, errno);
    return target;
}

} // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), temporary_(writableTarget(path)) {
    if (temporary_.error() != 0) failToWrite(path_, temporary_.error());
}

void AtomicFile::put(std::span<const char> bytes) {
    const std::uint64_t sent = begin_ / kSentAtOnce * kSentAtOnce;
    while (!bytes.empty()) {
        const ssize_t written =
            ::pwrite(temporary_.descriptor(), bytes.data(), bytes.size(), static_cast<off_t>(begin_));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) failToWrite(path_, written < 0 ? errno : ENOSPC);
        begin_ += static_cast<std::uint64_t>(written);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    if (begin_ < sent + kSentAtOnce) return;
    // Starts it; its faults are those of commit().
    ::sync_file_range(temporary_.descriptor(), static_cast<off_t>(sent), static_cast<off_t>(begin_ - sent),
                      SYNC_FILE_RANGE_WRITE);
}

void AtomicFile::flush() {
    put(waiting_);
    waiting_.clear();
}

void AtomicFile::write(std::span<const char> bytes) {
    if (waiting_.size() + bytes.size() > kMostWaiting) flush();
    if (bytes.size() > kMostWaiting)
        put(bytes);
    else
        waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
}

void AtomicFile::seek(std::uint64_t position) {
    if (position == this->position()) return;
    flush();
    begin_ = position;
}

const std::string& AtomicFile::temporaryPath() {
    flush();
    return temporary_.path();
}

void AtomicFile::commit(Flush flushed) {
    flush();
    if (const int error = temporary_.commit(flushed); error != 0) failToWrite(path_, error);
}

void writeAtomically(const std::string& path, std::span<const char> bytes, Flush flush) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit(flush);
}

} // namespace abbe
