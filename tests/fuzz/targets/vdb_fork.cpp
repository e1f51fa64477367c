// What the helper of volumes does with a file. It may be ended by a damaged one, which is why it is a process of its
// own, but keeps to its time and memory, and what it says until then is whole and the same each time.
#include "fuzz/target.h"
#include "vdb/commands.h"
#include "vdb/output.h"
#include "volumes/vdb_message.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <openvdb/openvdb.h>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

using namespace abbe;

namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr double kMostMiB = 6000; // the limit is left out there
#else
constexpr double kMostMiB = 2200;
#endif

[[noreturn]] void child(int output, const std::string& command, const std::vector<std::string>& arguments) {
    vdb::setLimits(arguments.front(), std::uint64_t{4} << 30);
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGVTALRM}) std::signal(signal, SIG_DFL);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
    vdb::takeOutput();
    vdb::run(command, arguments);
    ::_exit(0);
}

std::string readAll(int from) {
    std::string all;
    std::vector<char> piece(1 << 16);
    for (;;) {
        const ssize_t got = ::read(from, piece.data(), piece.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return all;
        all.append(piece.data(), static_cast<std::size_t>(got));
    }
}

// Whether the answer ends as a conversation does.
bool isWhole(std::string_view said) {
    while (said.size() >= sizeof(VdbFrameHead)) {
        VdbFrameHead head;
        std::memcpy(&head, said.data(), sizeof head);
        said.remove_prefix(sizeof head);
        if (head.size > said.size()) return false;
        const std::string content(said.substr(0, head.size));
        said.remove_prefix(head.size);
        if (head.kind == VdbFrame::end || head.kind == VdbFrame::fault) return said.empty();
        if (head.kind != VdbFrame::grid) continue;
        VdbGridHead grid;
        VdbUnpacker unpacker(content);
        unpacker(grid);
        if (!unpacker.ok() || grid.bytes > said.size()) return false;
        said.remove_prefix(grid.bytes);
    }
    return false;
}

std::string converse(const std::string& command, const std::vector<std::string>& arguments) {
    int ends[2];
    fuzz::require(::pipe(ends) == 0, "no pipe");
    const pid_t pid = ::fork();
    fuzz::require(pid >= 0, "no child");
    if (pid == 0) child(ends[1], command, arguments);
    ::close(ends[1]);
    const std::string said = readAll(ends[0]);
    ::close(ends[0]);
    int status = 0;
    rusage used{};
    while (::wait4(pid, &status, 0, &used) < 0 && errno == EINTR) {
    }
    fuzz::require(!WIFSIGNALED(status) || (WTERMSIG(status) != SIGXCPU && WTERMSIG(status) != SIGKILL),
                  "the helper runs for too long");
    fuzz::require(static_cast<double>(used.ru_maxrss) / 1024 < kMostMiB, "the helper takes too much memory");
    fuzz::require(!WIFEXITED(status) || WEXITSTATUS(status) != 0 || isWhole(said), "the helper says half a thing");
    return said;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    openvdb::initialize();
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    fuzz::require(converse("info", {file.path()}) == converse("info", {file.path()}),
                  "the helper says two things of one file");
    converse("read", {file.path(), "density", "1", "velocity", "2?"});
    return 0;
}
