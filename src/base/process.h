// Other programs: started without a shell, and waited for.
#pragma once

#include <span>
#include <string>
#include <sys/types.h>
#include <vector>

namespace abbe {

// What a program said and how it ended.
struct ProcessEnd {
    int code = 0; // exit code; 128 + signal; 127 if it could not be started, and then `err` says why
    std::string out, err;
};

// Runs a program, found on the PATH, to its end. Reads nothing from stdin.
ProcessEnd runProcess(const std::vector<std::string>& words);

// Starts a program, found on the PATH if its name has no slash, with these descriptors for stdout and stderr; it reads
// nothing from stdin and has the signals of a fresh program; `apart`: not those of the terminal, such as Ctrl-C.
// Returns errno, 0 when it runs.
int spawnProcess(const std::vector<std::string>& words, int out, int err, pid_t& process, bool apart = false);

// A program that is fed through its stdin; it says nothing on stdout that anybody wants. Interrupts of the terminal do
// not reach it, so that it ends when its food does. Requires SIGPIPE to be ignored.
class FedProcess {
  public:
    // Throws std::system_error if it cannot be started.
    explicit FedProcess(const std::vector<std::string>& words);
    // Kills it, if it still runs.
    ~FedProcess();
    FedProcess(const FedProcess&) = delete;
    FedProcess& operator=(const FedProcess&) = delete;

    // False: it has ended, or took nothing for a minute. Waits while it is slow.
    bool feed(std::span<const char> bytes);
    // Nothing more comes. Waits for its end; `out` is empty.
    ProcessEnd finish();

  private:
    void hangUp();

    pid_t process_ = -1;
    int food_ = -1, said_ = -1; // descriptors: its stdin, and a file without a name of what it says
};

// A program that goes on beside this one. Its output is appended to a file.
class ChildProcess {
  public:
    // Throws std::system_error if it cannot be started or the file not be opened.
    ChildProcess(const std::vector<std::string>& words, const std::string& outputFile);
    // Ends it (SIGTERM) and waits, if it still runs.
    ~ChildProcess();
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&&) = delete;

    // Whether it still runs; if not, code() is known.
    bool running();
    int code() const { return code_; }
    void terminate();
    // Waits for its end.
    void wait();

  private:
    pid_t process_ = -1;
    int code_ = 0;
};

} // namespace abbe
