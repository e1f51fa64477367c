// Who of several processes writes what belongs to one file.
#pragma once

#include <string>

namespace abbe {

// Held by one process at a time for as long as the object lives: a lock on `room.exr.abbe-lock` beside `room.exr`, made
// for it and removed with it. What a killed process left behind serves the next one. Where it cannot be had, as on file
// systems without locks, or where something else has that name, there is none: it is for order among those that mean
// well, and no reason to lose what they write.
class PathLock {
  public:
    // Waits while others hold it, for so long at most.
    PathLock(const std::string& path, double mostSeconds);
    ~PathLock();
    PathLock(const PathLock&) = delete;
    PathLock& operator=(const PathLock&) = delete;

    // Whether another process still held it in the end.
    bool refused() const { return refused_; }

  private:
    std::string name_;
    int file_ = -1; // held
    bool refused_ = false;
};

} // namespace abbe
