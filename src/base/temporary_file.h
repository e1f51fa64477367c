// A file that nobody else touches until it gets its name.
#pragma once

#include <string>

namespace abbe {

// Beside the file that it is to become: `room.exr.abbe-HOST-RANDOM.tmp`, a name that nothing had, which only this user
// may read. It is removed with the object unless commit() was called. What a killed process left behind is removed by
// the next one that writes the same file: a lock tells it from what is being written. Functions return errno, 0 when
// all is well.
class TemporaryFile {
  public:
    // Makes it; error() says whether that was possible. `target` is no link, since those would be replaced.
    explicit TemporaryFile(const std::string& target);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    int error() const { return error_; }
    int descriptor() const { return descriptor_; }
    const std::string& path() const { return path_; }
    // Onto the disk, with the mode and group of the file that it replaces, or the mode that a new one gets; then under
    // its name. Once. After a fault it is removed, and what was there stays.
    int commit();

  private:
    int publish();

    std::string target_, path_;
    int descriptor_ = -1, error_ = 0;
};

} // namespace abbe
