// A library that is loaded before all others (LD_PRELOAD) and has one of a program's calls of the file system fail, so
// that every one of them can be made to in turn. It knows no more of the program than these variables say:
//   FAULT_FOLDER=DIR   files in it count, and text on stdout and stderr; nothing else does
//   FAULT_AT=N         the number of the call, from 1; 0 or absent: none
//   FAULT_KIND=fail    it fails (EIO) and has done nothing
//              full    it and all later ones that need room in the folder fail (ENOSPC)
//              short   of a write, half is done, which is no fault
//              tear    of a write, half is done, then the process is killed; after any other call it is killed at once
//   FAULT_LOG=FILE     gets a line for each call: "12 rename o.exr"; the last one has a `*` where a fault was made
// Calls are counted over all threads. What is called from within the C library is not seen (fopen, fwrite).
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <string>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

enum class Kind { none, fail, full, shortly, tear };

// What is to be done with one call.
enum class Verdict { go, fail, full, half, tear };

struct Settings {
    std::string folder, log;
    long at = 0;
    Kind kind = Kind::none;
};

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

const Settings& settings() {
    static const Settings made = [] {
        Settings s;
        char real[PATH_MAX];
        s.folder = ::realpath(variable("FAULT_FOLDER").c_str(), real) ? std::string(real) + "/" : "/nowhere/";
        s.log = variable("FAULT_LOG");
        s.at = std::atol(variable("FAULT_AT").c_str());
        const std::string kind = variable("FAULT_KIND");
        s.kind = kind == "fail"    ? Kind::fail
                 : kind == "full"  ? Kind::full
                 : kind == "short" ? Kind::shortly
                 : kind == "tear"  ? Kind::tear
                                   : Kind::none;
        return s;
    }();
    return made;
}

std::atomic<long> calls{0};
std::atomic<bool> isFull{false};

void log(long number, const char* what, const std::string& path, bool fault) {
    if (settings().log.empty()) return;
    const std::string line = std::to_string(number) + (fault ? "* " : " ") + what + " " + path + "\n";
    const long file = ::syscall(SYS_openat, AT_FDCWD, settings().log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (file < 0) return;
    ::syscall(SYS_write, file, line.data(), line.size());
    ::syscall(SYS_close, file);
}

[[noreturn]] void die() {
    ::kill(::getpid(), SIGKILL);
    for (;;) ::pause();
}

std::string absolute(const char* path) {
    if (path[0] == '/') return path;
    char here[PATH_MAX];
    return ::getcwd(here, sizeof here) ? std::string(here) + "/" + path : std::string(path);
}

// The name in the folder, or nothing.
std::string counted(const std::string& path) {
    const std::string& folder = settings().folder;
    return path.compare(0, folder.size(), folder) == 0 ? path.substr(folder.size()) : std::string();
}

std::string counted(int descriptor) {
    if (descriptor == STDOUT_FILENO) return "(stdout)";
    if (descriptor == STDERR_FILENO) return "(stderr)";
    char target[PATH_MAX];
    const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
    const ssize_t size = ::readlink(link.c_str(), target, sizeof target);
    return size > 0 ? counted(std::string(target, static_cast<std::size_t>(size))) : std::string();
}

// `room`: whether a full disk has it fail.
Verdict judge(const char* what, const std::string& name, bool room, bool writes) {
    if (name.empty()) return Verdict::go;
    const Settings& s = settings();
    const long number = ++calls;
    const bool here = number == s.at && s.kind != Kind::none;
    log(number, what, name, here);
    if (s.kind == Kind::full) {
        if (here) isFull = true;
        return isFull && room && name[0] != '(' ? Verdict::full : Verdict::go;
    }
    if (!here) return Verdict::go;
    if (s.kind == Kind::fail) return Verdict::fail;
    if (s.kind == Kind::shortly) return writes ? Verdict::half : Verdict::go;
    return Verdict::tear;
}

// The call, or its fault. `half` does a part of it.
template <typename Call, typename Half> long execute(Verdict verdict, const Call& call, const Half& half) {
    switch (verdict) {
    case Verdict::go:
        return call();
    case Verdict::fail:
        errno = EIO;
        return -1;
    case Verdict::full:
        errno = ENOSPC;
        return -1;
    case Verdict::half:
        return half();
    case Verdict::tear:
        half();
        die();
    }
    return -1;
}

template <typename Call> long execute(Verdict verdict, const Call& call) { return execute(verdict, call, call); }

template <typename Function> Function next(const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

long openFile(int folder, const char* path, int flags, unsigned mode) {
    const auto call = [&] { return ::syscall(SYS_openat, folder, path, flags, mode); };
    const bool changes = (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0 && (folder == AT_FDCWD || path[0] == '/');
    return changes ? execute(judge("open", counted(absolute(path)), (flags & O_CREAT) != 0, false), call) : call();
}

unsigned modeOf(int flags, va_list arguments) { return (flags & O_CREAT) != 0 ? va_arg(arguments, unsigned) : 0; }

} // namespace

extern "C" {

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const unsigned mode = modeOf(flags, arguments);
    va_end(arguments);
    return static_cast<int>(openFile(AT_FDCWD, path, flags, mode));
}

int open64(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const unsigned mode = modeOf(flags, arguments);
    va_end(arguments);
    return static_cast<int>(openFile(AT_FDCWD, path, flags, mode));
}

int mkostemps(char* pattern, int suffix, int flags) {
    const auto call = [&] { return long{next<int (*)(char*, int, int)>("mkostemps")(pattern, suffix, flags)}; };
    return static_cast<int>(execute(judge("create", counted(absolute(pattern)), true, false), call));
}

ssize_t write(int file, const void* data, std::size_t size) {
    const auto call = [&] { return ::syscall(SYS_write, file, data, size); };
    const auto half = [&] { return ::syscall(SYS_write, file, data, size > 1 ? size / 2 : size); };
    return execute(judge("write", counted(file), true, true), call, half);
}

ssize_t writev(int file, const iovec* parts, int count) {
    const auto call = [&] { return ::syscall(SYS_writev, file, parts, count); };
    const auto half = [&] { return ::syscall(SYS_writev, file, parts, 1); };
    return execute(judge("write", counted(file), true, true), call, half);
}

ssize_t pwrite(int file, const void* data, std::size_t size, off_t at) {
    const auto call = [&] { return ::syscall(SYS_pwrite64, file, data, size, at); };
    const auto half = [&] { return ::syscall(SYS_pwrite64, file, data, size > 1 ? size / 2 : size, at); };
    return execute(judge("write", counted(file), true, true), call, half);
}

ssize_t pwrite64(int file, const void* data, std::size_t size, off_t at) { return pwrite(file, data, size, at); }

int fsync(int file) {
    const auto call = [&] { return ::syscall(SYS_fsync, file); };
    return static_cast<int>(execute(judge("fsync", counted(file), true, false), call));
}

// A failing close has closed all the same.
int close(int file) {
    const int flags = static_cast<int>(::syscall(SYS_fcntl, file, F_GETFL));
    const bool changes = flags >= 0 && (flags & (O_WRONLY | O_RDWR)) != 0 && file > STDERR_FILENO;
    const Verdict verdict = changes ? judge("close", counted(file), false, false) : Verdict::go;
    const long result = ::syscall(SYS_close, file);
    return static_cast<int>(execute(verdict, [&] { return result; }));
}

int rename(const char* from, const char* to) {
    const auto call = [&] { return ::syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to); };
    return static_cast<int>(execute(judge("rename", counted(absolute(to)), false, false), call));
}

} // extern "C"
