#include "volumes/vdb_file.h"

#include "base/memory_limit.h"
#include "base/named_arrays.h"
#include "base/process.h"
#include "base/program_folder.h"
#include "volumes/vdb_message.h"

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace abbe {

namespace {

// The helper abbe-vdb as a child process whose output is read.
class VdbProcess {
  public:
    // Starts abbe-vdb, which lies beside the running program, in ../lib/abbe, or in the folder above (tests, in a build
    // tree). Check started().
    explicit VdbProcess(const std::vector<std::string>& arguments);
    // Ends the child if it still runs.
    ~VdbProcess();
    VdbProcess(const VdbProcess&) = delete;
    VdbProcess& operator=(const VdbProcess&) = delete;

    bool started() const { return pid_ > 0; }
    // Why it could not be started.
    const std::string& error() const { return error_; }
    // Fills the bytes; false when the child's output ends before.
    bool read(void* bytes, std::size_t size);
    // After the output has ended: how the child did, for a message; nullopt when it ended by itself.
    std::optional<std::string> deathCause();

  private:
    void wait();

    pid_t pid_ = -1;
    int output_ = -1;
    int status_ = 0;
    bool waited_ = false;
    std::string error_;
};

std::string helperPath() {
    const auto folder = programFolder();
    if (folder.empty()) return {};
    for (const char* place : {".", "../lib/abbe", ".."}) {
        const auto path = folder / place / "abbe-vdb";
        if (::access(path.c_str(), X_OK) == 0) return path.lexically_normal().string();
    }
    return {};
}

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
    std::vector<std::string> words{path, fmt::format("{:.0f}", memoryLimit())};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); // for messages of libraries
    const int failed = spawnProcess(words, ends[1], nowhere, pid_);
    if (nowhere >= 0) ::close(nowhere);
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

constexpr std::uint64_t kMostContent = std::uint64_t{1} << 30; // of a frame that is not a grid

// One run of the helper, frame by frame. The first fault is kept and ends it.
class HelperSession {
  public:
    HelperSession(const std::vector<std::string>& arguments, std::string subject)
        : process_(arguments), subject_(std::move(subject)) {
        if (!process_.started()) fault_ = VdbFault{VdbFault::Kind::helper, process_.error(), {}};
    }

    // The next frame that is neither end nor fault.
    std::optional<VdbFrame> next() {
        if (fault_ || ended_) return std::nullopt;
        VdbFrameHead head;
        if (!process_.read(&head, sizeof head)) return died();
        if (head.size > kMostContent) return damaged();
        content_.resize(head.size);
        if (!process_.read(content_.data(), content_.size())) return died();
        if (head.kind == VdbFrame::fault) {
            fault_.emplace();
            if (!unpack(*fault_)) return damaged();
            return std::nullopt;
        }
        ended_ = head.kind == VdbFrame::end;
        return ended_ ? std::nullopt : std::optional(head.kind);
    }
    // Reads the content of the frame just given; false when it is not that.
    template <typename T> bool unpack(T& value) const {
        VdbUnpacker unpacker(content_);
        unpacker(value);
        return unpacker.ok();
    }
    bool read(GridBytes& bytes) {
        if (process_.read(bytes.data(), bytes.size())) return true;
        died();
        return false;
    }
    std::nullopt_t beyondMemory(const std::bad_alloc& e) {
        fault_ = VdbFault{VdbFault::Kind::memory, fmt::format("{}: {}", subject_, memoryReason(e)), {}};
        return std::nullopt;
    }
    std::nullopt_t damaged() {
        fault_ = VdbFault{VdbFault::Kind::damaged, fmt::format("{} is damaged", subject_), {}};
        return std::nullopt;
    }
    std::optional<VdbFault> takeFault() {
        if (!fault_ && !ended_) damaged();
        return std::move(fault_);
    }

  private:
    std::nullopt_t died() {
        const auto cause = process_.deathCause();
        fault_ =
            VdbFault{VdbFault::Kind::damaged,
                     fmt::format("{} is damaged: the reader {}", subject_, cause.value_or("stopped in the middle")),
                     {}};
        return std::nullopt;
    }

    VdbProcess process_;
    std::string subject_;
    std::string content_;
    std::optional<VdbFault> fault_;
    bool ended_ = false;
};

std::optional<VdbFault> checkReadable(const std::string& path) {
    const auto fault = [&](const char* why) {
        return VdbFault{VdbFault::Kind::file, fmt::format("cannot read `{}`: {}", path, why), {}};
    };
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0 || ::access(path.c_str(), R_OK) != 0) return fault(std::strerror(errno));
    if (!S_ISREG(status.st_mode)) return fault("it is not a regular file");
    return std::nullopt;
}

// Reads the grid behind a frame that announced it.
bool receive(HelperSession& talk, VdbGrid& grid) {
    VdbGridHead head;
    if (!talk.unpack(head) || !head.facts.indexToWorld.inverse()) {
        talk.damaged();
        return false;
    }
    GridBytes bytes;
    try {
        requireMemory(static_cast<double>(head.bytes));
        bytes = GridBytes(head.bytes);
    } catch (const std::bad_alloc& e) {
        talk.beyondMemory(e);
        return false;
    }
    if (!talk.read(bytes)) return false;
    grid.notes = std::move(head.notes);
    if (head.vector)
        grid.vector = VectorGrid::adopt(std::move(bytes), std::move(head.facts));
    else
        grid.scalar = VoxelGrid::adopt(std::move(bytes), std::move(head.facts));
    if (grid.vector || grid.scalar) return true;
    talk.damaged();
    return false;
}

std::string subjectOf(const std::string& path) { return fmt::format("`{}`", path); }

} // namespace

std::variant<std::vector<VdbGrid>, VdbFault> readVdb(const std::string& path, std::span<const VdbRequest> requests) {
    if (const auto arrays = findArrays(path)) return gridsOf(*arrays, path, requests);
    if (auto fault = checkReadable(path)) return *fault;
    std::vector<std::string> arguments{"read", path};
    for (const VdbRequest& r : requests) {
        arguments.push_back(r.grid);
        arguments.push_back(fmt::format("{}{}", static_cast<int>(r.use), r.optional ? "?" : ""));
    }
    HelperSession talk(arguments, subjectOf(path));
    std::vector<VdbGrid> grids;
    while (const auto frame = talk.next()) {
        if (*frame == VdbFrame::noGrid) {
            grids.emplace_back();
        } else if (*frame == VdbFrame::grid) {
            if (!receive(talk, grids.emplace_back())) {
                grids.pop_back();
                break;
            }
        }
    }
    if (auto fault = talk.takeFault()) {
        fault->request = std::min(grids.size(), requests.size() - 1);
        return *fault;
    }
    if (grids.size() != requests.size())
        return VdbFault{VdbFault::Kind::helper, "the helper `abbe-vdb` is not of this version", {}};
    return grids;
}

std::variant<VdbFileInfo, VdbFault> inspectVdb(const std::string& path) {
    if (auto fault = checkReadable(path)) return *fault;
    HelperSession talk({"info", path}, subjectOf(path));
    VdbFileInfo info;
    while (const auto frame = talk.next())
        if (*frame == VdbFrame::fileInfo && !talk.unpack(info)) talk.damaged();
    if (auto fault = talk.takeFault()) return *fault;
    return info;
}

std::variant<std::string, VdbFault> runVdbHelper(const std::vector<std::string>& arguments,
                                                 const std::function<void(double)>& progress) {
    HelperSession talk(arguments, "the volume");
    std::string text;
    while (const auto frame = talk.next()) {
        double fraction = 0;
        if (*frame == VdbFrame::text) talk.unpack(text);
        if (*frame == VdbFrame::progress && progress && talk.unpack(fraction)) progress(fraction);
    }
    if (auto fault = talk.takeFault()) return *fault;
    return text;
}

} // namespace abbe
