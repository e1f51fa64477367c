// Files on disk: those that are read, and those that nobody else touches until they get their names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace abbe {

// Files that are read: regular ones alone. A pipe would make the reader wait, a device may have no end.
class RegularFile {
  public:
    // Never waits, whatever is there under that name.
    explicit RegularFile(const std::string& path);
    ~RegularFile();
    RegularFile(RegularFile&& other) noexcept
        : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_), why_(std::move(other.why_)) {}
    RegularFile& operator=(RegularFile&&) = delete;

    bool good() const { return why_.empty(); }
    // Why it could not be opened or read: "No such file or directory", "it is not a regular file".
    const std::string& why() const { return why_; }
    // Bytes when it was opened: no more are ever read.
    std::uint64_t size() const { return size_; }
    // Fills `to` from there on, as far as the file goes; how many bytes came. Fewer also after an error, see good().
    std::size_t readAt(std::uint64_t offset, std::span<char> to);
    // The same from any thread, for those who do not ask why.
    std::size_t copyAt(std::uint64_t offset, std::span<char> to) const;
    // These bytes will be copied soon: the system may begin to read them. Any thread.
    void expect(std::uint64_t offset, std::uint64_t size) const;
    // All of it, likewise. Requires that there is memory for size() bytes.
    std::string readAll();

  private:
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
    std::string why_;
};

// What tells that a file is still the same without reading it. Two that compare equal were not written in between.
struct FileIdentity {
    std::uint64_t device = 0, number = 0, size = 0; // all 0 where there is none
    std::int64_t modified = 0, changed = 0;         // ns
    // ns, when it was looked at, if that was so soon after a change that another one might not show in its times: it
    // then equals no other.
    std::int64_t unsure = 0;

    bool operator==(const FileIdentity&) const = default;
};
FileIdentity identityOf(const std::string& path);

// Empty, or why a library that opens files itself is not to be given this one.
inline std::string whyNotRegular(const std::string& path) { return RegularFile(path).why(); }

// Whether a file is on the disk before it gets its name. `later` is for one of many, which flushFileSystem() follows,
// or for one that nobody misses when the machine stops.
enum class Flush : bool { now, later };

// All that was written to the file system of a folder, as far as that can be had.
void flushFileSystem(const std::string& folder);

// A file that nobody else touches until it gets its name.
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
    // Onto the disk (or later, if asked for), with the mode and group of the file that it replaces, or the mode that a
    // new one gets; then under its name. Once. After a fault it is removed, and what was there stays.
    int commit(Flush = Flush::now);

  private:
    int publish(Flush);

    std::string target_, path_;
    int descriptor_ = -1, error_ = 0;
};

} // namespace abbe
