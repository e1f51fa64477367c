// The language server: bytes of an editor in, bytes for the editor out. It has no threads, no clock and no pipes of its
// own, so that tests can drive it.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::lsp {

struct CheckJob;
struct CheckResult;

// Lays a text without syntax errors out, as `abbe fmt` does.
using Formatter = std::function<std::string(std::string_view)>;

class Server {
  public:
    using Clock = std::chrono::steady_clock;
    // Is given whole messages with their headers.
    using Send = std::function<void(std::string_view)>;

    // Without a formatter editors are told that there is none.
    explicit Server(Send, Formatter = {});
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    // Pieces of the stream, cut anywhere. Requests are answered before it returns, unless a later message of the same
    // piece cancels them. `now` is when the bytes came.
    void receive(std::string_view bytes, Clock::time_point now);
    // The code with which the program ends, once the editor wants that: 0 after `shutdown`.
    std::optional<int> exitCode() const;
    // The same where the stream ends without an `exit`.
    int exitCodeAtEnd() const;

    // Checks of open texts are slow, and left to the caller: one at a time, some time after the last change.
    std::optional<Clock::time_point> nextCheck() const;
    // The job that is due, whose result must follow; null if there is none, or one is being done.
    std::unique_ptr<CheckJob> takeCheck(Clock::time_point now);
    // Tells the editor. `complete` is false for what a check knows early.
    void checked(const CheckResult&, bool complete);

  private:
    class State;
    std::unique_ptr<State> state_;
};

// Serves the editor at the other end of two descriptors until it says `exit` or the stream ends. Returns the code with
// which the program ends. Requires SIGPIPE to be ignored.
int runLanguageServer(int in, int out, Formatter = {});

} // namespace abbe::lsp
