#include "language_server/checking.h"
#include "language_server/server.h"

#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <limits>
#include <mutex>
#include <poll.h>
#include <sys/eventfd.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace abbe::lsp {

namespace {

// Checks texts one after the other in a thread of its own: an editor gets its answers while a scene's files are read.
class CheckThread {
  public:
    CheckThread() : wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), thread_([this] { run(); }) {}
    ~CheckThread() {
        {
            const std::lock_guard lock(mutex_);
            ends_ = true;
        }
        wanted_.notify_one();
        thread_.join();
        if (wake_ >= 0) ::close(wake_);
    }
    CheckThread(const CheckThread&) = delete;
    CheckThread& operator=(const CheckThread&) = delete;

    struct Result {
        CheckResult found;
        bool complete = false;
    };

    void start(std::unique_ptr<CheckJob> job) {
        {
            const std::lock_guard lock(mutex_);
            job_ = std::move(job);
            busy_ = true;
        }
        wanted_.notify_one();
    }
    bool busy() const {
        const std::lock_guard lock(mutex_);
        return busy_;
    }
    // Readable when there are results.
    int descriptor() const { return wake_; }
    std::deque<Result> takeResults() {
        std::uint64_t count = 0;
        [[maybe_unused]] const ssize_t bytes = ::read(wake_, &count, sizeof count);
        const std::lock_guard lock(mutex_);
        return std::exchange(results_, {});
    }

  private:
    void run() {
        for (;;) {
            std::unique_ptr<CheckJob> job;
            {
                std::unique_lock lock(mutex_);
                wanted_.wait(lock, [&] { return ends_ || job_; });
                if (ends_) return;
                job = std::move(job_);
            }
            CheckResult result = check(*job, [&](CheckResult early) { give({std::move(early), false}); });
            give({std::move(result), true});
        }
    }

    void give(Result result) {
        {
            const std::lock_guard lock(mutex_);
            if (result.complete) busy_ = false;
            results_.push_back(std::move(result));
        }
        const std::uint64_t one = 1;
        [[maybe_unused]] const ssize_t bytes = ::write(wake_, &one, sizeof one);
    }

    int wake_;
    mutable std::mutex mutex_;
    std::condition_variable wanted_;
    std::unique_ptr<CheckJob> job_;
    std::deque<Result> results_;
    bool busy_ = false, ends_ = false;
    std::thread thread_; // the last member: it uses the others
};

// False when the other side is gone.
bool writeAll(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0 && errno == EAGAIN) {
            pollfd writable{descriptor, POLLOUT, 0};
            ::poll(&writable, 1, -1);
            continue;
        }
        if (written <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

// Milliseconds for poll(): rounded up, -1 for ever.
int waitFor(std::optional<Server::Clock::time_point> when) {
    if (!when) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*when - Server::Clock::now()).count();
    return static_cast<int>(std::clamp<long long>(left, 0, std::numeric_limits<int>::max()));
}

} // namespace

int runLanguageServer(int in, int out, Formatter format) {
    bool open = true;
    Server server([&](std::string_view message) { open = open && writeAll(out, message); }, std::move(format));
    CheckThread checks;
    std::array<char, 1 << 16> buffer{};
    while (open && !server.exitCode()) {
        if (auto job = server.takeCheck(Server::Clock::now())) checks.start(std::move(job));
        std::array<pollfd, 2> ready = {pollfd{in, POLLIN, 0}, pollfd{checks.descriptor(), POLLIN, 0}};
        if (::poll(ready.data(), ready.size(), waitFor(server.nextCheck())) < 0 && errno != EINTR) break;
        if (ready[0].revents != 0) {
            const ssize_t bytes = ::read(in, buffer.data(), buffer.size());
            if (bytes < 0 && (errno == EINTR || errno == EAGAIN)) continue;
            if (bytes <= 0) break;
            server.receive({buffer.data(), static_cast<std::size_t>(bytes)}, Server::Clock::now());
        }
        if (ready[1].revents != 0)
            for (const auto& result : checks.takeResults()) server.checked(result.found, result.complete);
    }
    const int code = server.exitCode().value_or(server.exitCodeAtEnd());
    if (checks.busy()) ::_exit(code); // an editor does not wait for the end of a check
    return code;
}

} // namespace abbe::lsp
