#include "base/file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace abbe {

namespace {

std::int64_t nanoseconds(const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; }

} // namespace

FileIdentity identityOf(const std::string& path) {
    // Times of files come in ticks of the kernel, of up to 10 ms: what is written twice in one has one time.
    constexpr std::int64_t kUnsure = 40'000'000; // ns
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return {};
    FileIdentity file{static_cast<std::uint64_t>(status.st_dev),
                      static_cast<std::uint64_t>(status.st_ino),
                      static_cast<std::uint64_t>(status.st_size),
                      nanoseconds(status.st_mtim),
                      nanoseconds(status.st_ctim),
                      0};
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    if (std::max(file.modified, file.changed) + kUnsure > nanoseconds(now)) file.unsure = nanoseconds(now);
    return file;
}

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
    errno = 0;
    const std::size_t done = copyAt(offset, to);
    if (errno != 0 && good()) why_ = std::strerror(errno);
    return done;
}

std::size_t RegularFile::copyAt(std::uint64_t offset, std::span<char> to) const {
    if (!good() || offset >= size_) return 0;
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), size_ - offset));
    std::size_t done = 0;
    while (done < wanted) {
        const ssize_t got = ::pread(descriptor_, to.data() + done, std::min<std::size_t>(wanted - done, 1u << 30),
                                    static_cast<off_t>(offset + done));
        if (got < 0 && std::exchange(errno, errno == EINTR ? 0 : errno) == EINTR) continue;
        if (got <= 0) break; // or it was made shorter meanwhile
        done += static_cast<std::size_t>(got);
    }
    return done;
}

void RegularFile::expect(std::uint64_t offset, std::uint64_t size) const {
    ::posix_fadvise(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(size), POSIX_FADV_WILLNEED);
}

std::string RegularFile::readAll() {
    std::string bytes(size_, '\0');
    bytes.resize(readAt(0, bytes));
    return bytes;
}

namespace {

constexpr std::string_view kMark = ".abbe-", kEnding = ".tmp", kRandom = "XXXXXX";
constexpr std::size_t kLongestName = 255; // bytes, of common file systems
constexpr double kForeignAge = 24 * 3600; // s
constexpr int kTries = 16;

// Asked before there are threads, since asking means setting it.
const mode_t kUmask = [] {
    const mode_t mask = ::umask(077);
    ::umask(mask);
    return mask;
}();

// Locks of another machine may not be seen from here.
std::string hostMark() {
    char name[256] = {};
    ::gethostname(name, sizeof name - 1);
    std::uint32_t h = 2166136261u; // FNV-1a
    for (const char* c = name; *c; ++c) h = (h ^ static_cast<unsigned char>(*c)) * 16777619u;
    return fmt::format("{:06x}", h & 0xffffffu);
}

struct Place {
    std::string folder, name; // "./", "room.exr"
};

Place placeOf(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? Place{"./", path} : Place{path.substr(0, slash + 1), path.substr(slash + 1)};
}

// What all temporary names of a file begin with. A long name is cut: the whole must be one that can exist.
std::string beginningOf(const std::string& name, std::size_t hostSize) {
    const std::size_t added = kMark.size() + hostSize + 1 + kRandom.size() + kEnding.size();
    return name.substr(0, kLongestName - added) + std::string(kMark);
}

bool isOld(const struct stat& status) {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return std::difftime(now.tv_sec, status.st_mtim.tv_sec) > kForeignAge;
}

// Removes a file that no process holds.
void removeIfLeft(int folder, const char* name, bool ofThisHost) {
    const int file = ::openat(folder, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return;
    struct stat status {};
    const bool ours = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == ::geteuid();
    if (ours && (ofThisHost || isOld(status)) && ::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlinkat(folder, name, 0);
    ::close(file);
}

// Temporary files that a folder holds, whosever they are.
std::vector<std::string> temporaryFilesIn(const std::string& folder) {
    std::vector<std::string> names;
    const std::unique_ptr<DIR, int (*)(DIR*)> entries(::opendir(folder.c_str()), &::closedir);
    if (!entries) return names;
    while (const dirent* const entry = ::readdir(entries.get()))
        if (std::string_view(entry->d_name).ends_with(kEnding)) names.emplace_back(entry->d_name);
    return names;
}

void removeLeftovers(const Place& place, const std::string& host, const std::vector<std::string>& names) {
    const int folder = ::open(place.folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;
    const std::string beginning = beginningOf(place.name, host.size());
    const std::size_t size = beginning.size() + host.size() + 1 + kRandom.size() + kEnding.size();
    for (const std::string& name : names)
        if (name.size() == size && name.starts_with(beginning))
            removeIfLeft(folder, name.c_str(), std::string_view(name).substr(beginning.size()).starts_with(host));
    ::close(folder);
}

// Once for each file that this process writes: others come only from processes that end later. A folder is looked
// through once, since a scene may have ten thousand files in one.
void removeLeftoversOnce(const std::string& target, const Place& place, const std::string& host) {
    static std::mutex mutex;
    static std::set<std::string> done;
    static std::map<std::string, std::vector<std::string>> folders;
    const std::lock_guard lock(mutex);
    if (!done.insert(target).second) return;
    const auto [found, isNew] = folders.try_emplace(place.folder);
    if (isNew) found->second = temporaryFilesIn(place.folder);
    if (!found->second.empty()) removeLeftovers(place, host, found->second);
}

// Whether it is ours to write: somebody who looked for leftovers may have come between its making and its lock.
bool hold(int file) {
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK; // some file systems have no locks
    struct stat status {};
    return ::fstat(file, &status) == 0 && status.st_nlink > 0;
}

// Best effort: a rename is on disk once its folder is; some file systems cannot sync folders.
void syncFolder(const std::string& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

// Best effort: on some file systems all files have one mode.
void giveMode(int file, const std::string& target) {
    struct stat old {
    }, own{};
    mode_t mode = 0666 & ~kUmask;
    if (::stat(target.c_str(), &old) == 0 && ::fstat(file, &own) == 0) {
        mode = old.st_mode & 0777;
        // Where the file cannot have that group, another one gets no more than everybody.
        if (old.st_gid != own.st_gid && ::fchown(file, static_cast<uid_t>(-1), old.st_gid) != 0)
            mode &= ~(mode_t{070} & ~((mode & 07) << 3));
    }
    static_cast<void>(::fchmod(file, mode));
}

} // namespace

void flushFileSystem(const std::string& folder) {
    const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::syncfs(descriptor);
    ::close(descriptor);
}

TemporaryFile::TemporaryFile(const std::string& target) : target_(target) {
    static const std::string host = hostMark();
    const Place place = placeOf(target);
    removeLeftoversOnce(target, place, host);
    for (int i = 0; i < kTries; ++i) {
        path_ = fmt::format("{}{}{}-{}{}", place.folder, beginningOf(place.name, host.size()), host, kRandom, kEnding);
        // Exclusive, so that nothing is followed or opened that is there, and 0600.
        descriptor_ = ::mkostemps(path_.data(), static_cast<int>(kEnding.size()), O_CLOEXEC);
        if (descriptor_ < 0) break;
        if (hold(descriptor_)) return;
        ::close(descriptor_); // gone, or about to be
        descriptor_ = -1;
        errno = EEXIST;
    }
    error_ = errno;
}

TemporaryFile::~TemporaryFile() {
    if (descriptor_ < 0) return;
    ::unlink(path_.c_str());
    ::close(descriptor_);
}

int TemporaryFile::publish(Flush flush) {
    giveMode(descriptor_, target_);
    if (flush == Flush::now && ::fsync(descriptor_) != 0) return errno;
    // Network file systems report lost data when a descriptor is closed; the lock lasts as long as the other one.
    const int copy = ::dup(descriptor_);
    if (copy < 0 || ::close(copy) != 0) return errno;
    return ::rename(path_.c_str(), target_.c_str()) == 0 ? 0 : errno;
}

int TemporaryFile::commit(Flush flush) {
    const int error = publish(flush);
    if (error != 0) ::unlink(path_.c_str());
    ::close(descriptor_);
    descriptor_ = -1;
    if (error == 0 && flush == Flush::now) syncFolder(placeOf(target_).folder);
    return error;
}

} // namespace abbe
