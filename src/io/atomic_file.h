// A file that appears under its name only when it is complete.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace abbe {

// Writes to `path.tmp` in the same folder; commit() flushes it to disk and renames it. Without commit() the temporary
// file is removed and whatever was at `path` stays. A link is followed, so that its target is replaced. All functions
// throw IoError, after which the object is only good for destruction.
class AtomicFile {
  public:
    // Refuses paths that exist and are no regular files (folders, devices).
    explicit AtomicFile(const std::string& path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::span<const char> bytes);
    void seek(std::uint64_t position);
    std::uint64_t position() const { return position_; }
    // Where the bytes are until commit().
    const std::string& temporaryPath() const { return temporary_; }
    void commit();

  private:
    [[noreturn]] void fail(int error) const;

    std::string path_;   // as given, for messages
    std::string target_; // links resolved
    std::string temporary_;
    int descriptor_ = -1;
    std::uint64_t position_ = 0;
};

// A whole file at once.
void writeAtomically(const std::string& path, std::span<const char> bytes);

} // namespace abbe
