// The helper abbe-vdb as a child process whose output is read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace abbe {

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

} // namespace abbe
