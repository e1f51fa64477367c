// What a fuzz target is: the entry point of libFuzzer, which AFL++ knows too, and the driver of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

// Reads the bytes as a file of the target's kind. Whatever is in them, it returns 0; it aborts where a reader breaks
// its contract. The same bytes take the same way.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace abbe::fuzz {

inline std::string bytesOf(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

// A file in memory, for readers that want a path.
class MemoryFile {
  public:
    explicit MemoryFile(std::string_view bytes);
    ~MemoryFile();
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    // For this process and, while it runs, for its children.
    const std::string& path() const { return path_; }

  private:
    int descriptor_;
    std::string path_;
};

// Aborts with a message unless `good`: the target's contract.
void require(bool good, const char* what);

} // namespace abbe::fuzz
