// Other programs: started without a shell, and waited for.
#pragma once

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
// nothing from stdin and has the signals of a fresh program. Returns errno, 0 when it runs.
int spawnProcess(const std::vector<std::string>& words, int out, int err, pid_t& process);

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
