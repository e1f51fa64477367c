// Reading and writing whole files, and the error of every reader and writer here.
#pragma once

#include "base/file.h"

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// what() is one sentence: "cannot write `a.exr`: No space left on device".
class IoError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// A whole file in memory.
// Of a regular file. Throws IoError, and MemoryLimitExceeded before it reads more than may be taken.
std::string readFileBytes(const std::string& path);

// The same for files of gigabytes: memory that is not cleared before it is read into. Not mapped: a mapped file that
// somebody cuts off while it is read kills the process.
class LargeFile {
  public:
    explicit LargeFile(const std::string& path);
    std::string_view bytes() const { return {bytes_.get(), size_}; }

  private:
    std::unique_ptr<char[]> bytes_;
    std::size_t size_;
};

// A file that appears under its name only when it is complete.
// Writes to a temporary file in the same folder, which no other program writes to or reads; commit() flushes it to disk
// and renames it, with the mode of the file that it replaces or that of a new one. Without commit() the temporary
// file is removed and whatever was at the path stays. Of several that write one file the last to commit wins, whole. A
// link is followed, so that its target is replaced, but for one that another user put into a folder for everybody.
// All functions throw IoError, after which the object is only good for destruction.
class AtomicFile {
  public:
    // Refuses paths that exist and are no regular files (folders, devices).
    explicit AtomicFile(const std::string& path);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    // What is written may wait in memory, and its fault show later.
    void write(std::span<const char> bytes);
    void seek(std::uint64_t position);
    std::uint64_t position() const { return begin_ + waiting_.size(); }
    // Where all bytes so far are until commit().
    const std::string& temporaryPath();
    void commit(Flush = Flush::now);

  private:
    void flush();
    void put(std::span<const char> bytes);

    std::string path_; // as given, for messages
    TemporaryFile temporary_;
    std::vector<char> waiting_; // writers of headers write a few bytes at a time
    std::uint64_t begin_ = 0;   // where those belong
};

// A whole file at once.
void writeAtomically(const std::string& path, std::span<const char> bytes, Flush = Flush::now);

} // namespace abbe
