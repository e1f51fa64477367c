#include "base/text_output.h"

#include <cerrno>
#include <csignal>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <string>
#include <thread>
#include <unistd.h>

using namespace abbe;

namespace {

// What stands in the place of stdout while this lives.
class StandIn {
  public:
    explicit StandIn(int descriptor) : saved_(::dup(STDOUT_FILENO)) { ::dup2(descriptor, STDOUT_FILENO); }
    ~StandIn() {
        ::dup2(saved_, STDOUT_FILENO);
        ::close(saved_);
    }

  private:
    int saved_;
};

struct Pipe {
    Pipe() { REQUIRE(::pipe(ends) == 0); }
    ~Pipe() {
        ::close(ends[0]);
        ::close(ends[1]);
    }
    int ends[2];
};

} // namespace

TEST_CASE("a slow reader gets everything, also from a descriptor that does not wait") {
    const Pipe pipe;
    ::fcntl(pipe.ends[1], F_SETFL, O_NONBLOCK);
    const std::string text(3'000'000, 'x');
    std::string read;
    std::thread reader([&] {
        char buffer[5000];
        while (read.size() < text.size()) {
            const ssize_t n = ::read(pipe.ends[0], buffer, sizeof buffer);
            if (n <= 0) break;
            read.append(buffer, static_cast<std::size_t>(n));
        }
    });
    {
        const StandIn standIn(pipe.ends[1]);
        writeText(TextStream::out, text);
    }
    reader.join();
    CHECK(read == text);
    CHECK(lostText() == 0);
}

TEST_CASE("what takes nothing is asked before") {
    const Pipe pipe;
    ::fcntl(pipe.ends[1], F_SETFL, O_NONBLOCK);
    const StandIn standIn(pipe.ends[1]);
    CHECK(takesText(TextStream::out));
    const std::string page(4096, 'x');
    while (::write(pipe.ends[1], page.data(), page.size()) > 0) {
    }
    CHECK(!takesText(TextStream::out));
}

TEST_CASE("lost text is remembered, but not that of a reader who went away") {
    const auto old = std::signal(SIGPIPE, SIG_IGN);
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    ::close(ends[0]);
    {
        const StandIn standIn(ends[1]);
        writeText(TextStream::out, "nobody reads");
    }
    ::close(ends[1]);
    CHECK(lostText() == 0);
    const int full = ::open("/dev/full", O_WRONLY);
    if (full >= 0) {
        const StandIn standIn(full);
        writeText(TextStream::out, "no room");
        CHECK(lostText() == ENOSPC);
    }
    ::close(full);
    std::signal(SIGPIPE, old);
}
