#include "base/private_folder.h"

#include <cerrno>
#include <ctime>
#include <fcntl.h>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderLockEnding = ".lock";

int openFolderLock(const fs::path& folder) {
    const std::string path = folder.string() + kFolderLockEnding;
    for (;;) {
        const int file = ::open(path.c_str(), O_CREAT | O_RDWR | O_NOFOLLOW | O_CLOEXEC, 0600);
        if (file < 0) return -1;
        int failed = 0;
        do failed = ::flock(file, LOCK_SH);
        while (failed != 0 && errno == EINTR);
        struct stat held {
        }, named{};
        if (failed == 0 && ::fstat(file, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
            held.st_ino == named.st_ino) {
            ::futimens(file, nullptr);
            return file;
        }
        ::close(file);
        if (failed != 0) return -1; // else it was removed while this one waited
    }
}

double secondsSince(const timespec& moment) {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return std::difftime(now.tv_sec, moment.tv_sec);
}

} // namespace

int makePrivateFolder(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (::mkdir(path.c_str(), 0700) == 0) return 0;
    if (errno != EEXIST) return errno;
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) return errno;
    if (!S_ISDIR(status.st_mode)) return ENOTDIR;
    return status.st_uid != ::geteuid() || (status.st_mode & 077) != 0 ? EPERM : 0;
}

FolderUse::FolderUse(const fs::path& folder) : lock_(openFolderLock(folder)) {}

FolderUse::~FolderUse() {
    if (lock_ >= 0) ::close(lock_);
}

void removeUnusedFolders(const fs::path& cache, double seconds) {
    std::error_code error;
    std::vector<fs::path> locks;
    for (fs::directory_iterator it(cache, error), end; !error && it != end; it.increment(error))
        if (it->path().extension() == kFolderLockEnding) locks.push_back(it->path());
    for (const fs::path& lock : locks) {
        const int file = ::open(lock.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
        struct stat status {};
        if (file >= 0 && ::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &status) == 0 &&
            secondsSince(status.st_mtim) >= seconds) {
            fs::remove_all(fs::path(lock).replace_extension(), error);
            fs::remove(lock, error);
        }
        if (file >= 0) ::close(file);
    }
}

} // namespace abbe
