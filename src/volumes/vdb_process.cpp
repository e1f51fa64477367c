#include "volumes/vdb_process.h"

#include "base/memory_limit.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace abbe {

namespace {

std::string helperPath() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) return {};
    for (const char* place : {".", "../lib/abbe", ".."}) {
        const auto path = self.parent_path() / place / "abbe-vdb";
        if (::access(path.c_str(), X_OK) == 0) return path.lexically_normal().string();
    }
    return {};
}

// Output to our pipe, no input, no messages of libraries; the signals of a fresh program.
struct SpawnSetup {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;

    explicit SpawnSetup(int output) {
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawnattr_init(&attributes);
        sigset_t defaults;
        sigemptyset(&defaults);
        for (const int s : {SIGINT, SIGTERM, SIGPIPE, SIGABRT}) sigaddset(&defaults, s);
        posix_spawnattr_setsigdefault(&attributes, &defaults);
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    }
    ~SpawnSetup() {
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnSetup(const SpawnSetup&) = delete;
    SpawnSetup& operator=(const SpawnSetup&) = delete;
};

} // namespace

VdbProcess::VdbProcess(const std::vector<std::string>& arguments) {
    const std::string path = helperPath();
    if (path.empty()) {
        error_ = "the helper `abbe-vdb`, which reads OpenVDB files, is not beside the program";
        return;
    }
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
        error_ = fmt::format("cannot start `{}`: {}", path, std::strerror(errno));
        return;
    }
    const std::string memory = fmt::format("{:.0f}", memoryLimit());
    std::vector<char*> argv{const_cast<char*>(path.c_str()), const_cast<char*>(memory.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const SpawnSetup setup(ends[1]);
    const int failed = ::posix_spawn(&pid_, path.c_str(), &setup.actions, &setup.attributes, argv.data(), environ);
    ::close(ends[1]);
    output_ = ends[0];
    if (failed == 0) return;
    pid_ = -1;
    error_ = fmt::format("cannot start `{}`: {}", path, std::strerror(failed));
}

VdbProcess::~VdbProcess() {
    if (output_ >= 0) ::close(output_);
    if (pid_ > 0 && !waited_) {
        ::kill(pid_, SIGKILL);
        wait();
    }
}

bool VdbProcess::read(void* bytes, std::size_t size) {
    auto* next = static_cast<char*>(bytes);
    while (size > 0) {
        const ssize_t got = ::read(output_, next, size);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        next += got;
        size -= static_cast<std::size_t>(got);
    }
    return true;
}

void VdbProcess::wait() {
    while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    waited_ = true;
}

std::optional<std::string> VdbProcess::deathCause() {
    if (pid_ <= 0) return error_;
    if (!waited_) wait();
    if (WIFSIGNALED(status_)) {
        const int signal = WTERMSIG(status_);
        return signal == SIGXCPU ? std::string("ran for too long") : fmt::format("ended by {}", strsignal(signal));
    }
    if (WIFEXITED(status_) && WEXITSTATUS(status_) != 0) return fmt::format("ended with {}", WEXITSTATUS(status_));
    return std::nullopt;
}

} // namespace abbe
