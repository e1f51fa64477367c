// Files that are read: regular ones alone. A pipe would make the reader wait, a device may have no end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace abbe {

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
    // All of it, likewise. Requires that there is memory for size() bytes.
    std::string readAll();

  private:
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
    std::string why_;
};

// Empty, or why a library that opens files itself is not to be given this one.
inline std::string whyNotRegular(const std::string& path) { return RegularFile(path).why(); }

} // namespace abbe
