#include "base/text_output.h"

#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace abbe {

namespace {

std::atomic<int> lostForGood{0};

// Another program may have made the terminal one that does not wait.
bool waitForRoom(int descriptor) {
    pollfd asked{descriptor, POLLOUT, 0};
    while (::poll(&asked, 1, -1) < 0)
        if (errno != EINTR) return false;
    return (asked.revents & POLLOUT) != 0;
}

} // namespace

void writeText(TextStream stream, std::string_view text) noexcept {
    const int descriptor = static_cast<int>(stream);
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor, text.data(), text.size());
        if (written > 0) {
            text.remove_prefix(static_cast<std::size_t>(written));
            continue;
        }
        if (written < 0 && errno == EINTR) continue;
        if (written < 0 && errno == EAGAIN && waitForRoom(descriptor)) continue;
        if (stream == TextStream::out && errno != EPIPE) lostForGood = written < 0 ? errno : EIO;
        return;
    }
}

bool takesText(TextStream stream) noexcept {
    pollfd asked{static_cast<int>(stream), POLLOUT, 0};
    return ::poll(&asked, 1, 0) == 1 && (asked.revents & POLLOUT) != 0;
}

int lostText() noexcept { return lostForGood; }

void keepStandardStreams() noexcept {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
        // The lowest free number is this one, since those before it are taken. Where there are no devices a folder
        // stands in, which takes nothing either.
        if (::open("/dev/null", O_RDWR) < 0) static_cast<void>(::open("/", O_RDONLY | O_DIRECTORY));
    }
}

} // namespace abbe
