#include "base/process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
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

int spawnProcess(const std::vector<std::string>& words, int out, int err, pid_t& process) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
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
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    const int fault = posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return fault;
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
