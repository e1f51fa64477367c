#include "base/path_lock.h"

#include "base/stopwatch.h"

#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace abbe {

namespace {

constexpr std::string_view kLockEnding = ".abbe-lock";
constexpr std::size_t kLongestLockName = 255; // bytes, of common file systems
constexpr std::chrono::milliseconds kLockPause{5};

enum class Attempt { held, gone, busy, impossible };

// Empty and regular: anything else was put there by somebody else. Who held it before may have removed it meanwhile.
Attempt tryLock(int file, const std::string& name) {
    struct stat own {
    }, there{};
    if (::fstat(file, &own) != 0 || !S_ISREG(own.st_mode) || own.st_size != 0) return Attempt::impossible;
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) return errno == EWOULDBLOCK ? Attempt::busy : Attempt::impossible;
    const bool same = ::lstat(name.c_str(), &there) == 0 && there.st_dev == own.st_dev && there.st_ino == own.st_ino;
    return same ? Attempt::held : Attempt::gone;
}

} // namespace

PathLock::PathLock(const std::string& path, double mostSeconds) {
    const std::size_t slash = path.rfind('/'), begin = slash == std::string::npos ? 0 : slash + 1;
    name_ = path.substr(0, begin + kLongestLockName - kLockEnding.size()) + std::string(kLockEnding);
    const Stopwatch watch;
    for (;;) {
        const int file = ::open(name_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0600);
        if (file < 0) return;
        const Attempt attempt = tryLock(file, name_);
        if (attempt == Attempt::held) {
            file_ = file;
            return;
        }
        ::close(file);
        if (attempt == Attempt::impossible) return;
        refused_ = attempt == Attempt::busy && watch.seconds() >= mostSeconds;
        if (refused_) return;
        if (attempt == Attempt::busy) std::this_thread::sleep_for(kLockPause);
    }
}

PathLock::~PathLock() {
    if (file_ < 0) return;
    ::unlink(name_.c_str()); // first, so that nobody gets a lock on what is about to go
    ::close(file_);
}

} // namespace abbe
