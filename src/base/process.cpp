#include "base/process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

extern char** environ;

namespace abbe {

namespace {

int codeOfStatus(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

int waitForProcess(pid_t process) {
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return codeOfStatus(status);
}

struct Pipe {
    Pipe() {
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    }
    ~Pipe() {
        close(0);
        close(1);
    }
    void close(std::size_t end) {
        if (ends[end] >= 0) ::close(std::exchange(ends[end], -1));
    }
    // False at its end.
    bool readInto(std::string& text) {
        char buffer[4096];
        const ssize_t got = ::read(ends[0], buffer, sizeof buffer);
        if (got > 0) text.append(buffer, static_cast<std::size_t>(got));
        return got > 0 || (got < 0 && errno == EINTR);
    }
    std::array<int, 2> ends{-1, -1};
};

} // namespace

namespace {

// `in` < 0: nothing. `apart`: in a process group of its own, which the signals of the terminal do not reach.
int spawn(const std::vector<std::string>& words, int in, int out, int err, bool apart, pid_t& process) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (in >= 0)
        posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    else
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t defaults, none;
    sigfillset(&defaults);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, static_cast<short>(POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK |
                                                             (apart ? POSIX_SPAWN_SETPGROUP : 0)));
    const int fault = posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return fault;
}

} // namespace

int spawnProcess(const std::vector<std::string>& words, int out, int err, pid_t& process, bool apart) {
    return spawn(words, -1, out, err, apart, process);
}

ProcessEnd runProcess(const std::vector<std::string>& words) {
    Pipe out, err;
    ProcessEnd end;
    pid_t process = -1;
    if (const int fault = spawnProcess(words, out.ends[1], err.ends[1], process); fault != 0) {
        end.code = 127;
        end.err = std::strerror(fault);
        return end;
    }
    out.close(1);
    err.close(1);
    std::array<pollfd, 2> both{{{out.ends[0], POLLIN, 0}, {err.ends[0], POLLIN, 0}}};
    while (both[0].fd >= 0 || both[1].fd >= 0) {
        if (::poll(both.data(), both.size(), -1) < 0 && errno != EINTR) break;
        if (both[0].revents != 0 && !out.readInto(end.out)) both[0].fd = -1;
        if (both[1].revents != 0 && !err.readInto(end.err)) both[1].fd = -1;
        both[0].revents = both[1].revents = 0;
    }
    end.code = waitForProcess(process);
    return end;
}

FedProcess::FedProcess(const std::vector<std::string>& words) {
    Pipe food;
    said_ = ::memfd_create("said", MFD_CLOEXEC);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    int fault = said_ < 0 || nowhere < 0 ? errno : 0;
    if (fault == 0) fault = spawn(words, food.ends[0], nowhere, said_, true, process_);
    if (nowhere >= 0) ::close(nowhere);
    if (fault != 0) {
        process_ = -1;
        if (said_ >= 0) ::close(said_);
        throw std::system_error(fault, std::generic_category(), words[0]);
    }
    food_ = std::exchange(food.ends[1], -1);
    ::fcntl(food_, F_SETFL, O_NONBLOCK);
}

FedProcess::~FedProcess() {
    hangUp();
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        waitForProcess(process_);
    }
    ::close(said_);
}

void FedProcess::hangUp() {
    if (food_ >= 0) ::close(std::exchange(food_, -1));
}

bool FedProcess::feed(std::span<const char> bytes) {
    constexpr int kPatience = 60'000; // ms
    while (food_ >= 0 && !bytes.empty()) {
        const ssize_t n = ::write(food_, bytes.data(), bytes.size());
        if (n > 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(n));
            continue;
        }
        if (n < 0 && errno == EINTR) continue;
        if (n < 0 && errno != EAGAIN) break;
        pollfd wait{food_, POLLOUT, 0};
        if (::poll(&wait, 1, kPatience) == 0) break;
    }
    return bytes.empty();
}

ProcessEnd FedProcess::finish() {
    hangUp();
    constexpr int kLook = 10, kPatience = 600'000; // ms
    ProcessEnd end;
    int status = 0;
    for (int waited = 0; process_ > 0; waited += kLook) {
        if (::waitpid(process_, &status, WNOHANG) != 0) {
            end.code = codeOfStatus(status);
            process_ = -1;
        } else if (waited >= kPatience) {
            ::kill(process_, SIGKILL);
        } else {
            ::poll(nullptr, 0, kLook);
        }
    }
    ::lseek(said_, 0, SEEK_SET);
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(said_, buffer, sizeof buffer)) > 0;)
        end.err.append(buffer, static_cast<std::size_t>(n));
    return end;
}

ChildProcess::ChildProcess(const std::vector<std::string>& words, const std::string& outputFile) {
    const int file = ::open(outputFile.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file < 0) throw std::system_error(errno, std::generic_category(), outputFile);
    const int fault = spawnProcess(words, file, file, process_);
    ::close(file);
    if (fault != 0) throw std::system_error(fault, std::generic_category(), words[0]);
}

ChildProcess::~ChildProcess() {
    if (process_ < 0) return;
    terminate();
    wait();
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)), code_(other.code_) {}

bool ChildProcess::running() {
    if (process_ < 0) return false;
    int status = 0;
    if (::waitpid(process_, &status, WNOHANG) == 0) return true;
    code_ = codeOfStatus(status);
    process_ = -1;
    return false;
}

void ChildProcess::terminate() {
    if (process_ > 0) ::kill(process_, SIGTERM);
}

void ChildProcess::wait() {
    if (process_ < 0) return;
    code_ = waitForProcess(process_);
    process_ = -1;
}

} // namespace abbe
