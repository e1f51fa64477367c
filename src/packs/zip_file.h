// ZIP archives, of which a pack is one. The library that knows the format is known to zip_file.cpp alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// Reads an archive that may have been made by anybody to do harm: no more is allocated or read than its own size and
// the limits of packs/manifest.h account for. Everything throws PackFault.
class ZipReader {
  public:
    struct Entry {
        std::string name; // a good one (nameFault), or of a folder with a slash at its end
        std::uint64_t bytes = 0;
        std::uint64_t index = 0;
    };

    // Refuses what is no ZIP file; names that are not good or there twice; links, devices and the like; encryption;
    // methods other than stored and deflated.
    explicit ZipReader(const std::string& path);
    ~ZipReader();
    ZipReader(const ZipReader&) = delete;
    ZipReader& operator=(const ZipReader&) = delete;

    const std::vector<Entry>& entries() const { return entries_; }
    // Gives all bytes of an entry to `sink`, portion by portion: exactly as many as it promises, with the right
    // checksum.
    void read(const Entry&, const std::function<void(std::span<const char>)>& sink) const;

  private:
    struct Archive;
    [[noreturn]] void fail(const std::string& what) const;
    void addEntry(std::uint64_t index);

    std::string path_;
    std::unique_ptr<Archive> archive_;
    std::vector<Entry> entries_;
};

// What goes into an archive: a text, or a file on disk with what was found in it before.
struct ZipSource {
    std::string name;
    std::string text; // of an entry without a path
    std::string path;
    std::uint64_t bytes = 0;
    std::string sha256;
    bool deflate = false;
};

// Writes an archive that appears under its name when it is complete, with the entries in their order. The same entries
// make the same bytes: no times, owners or modes are in it. Files are read while it is written, never as a whole; one
// that is not what was found before is a fault. Throws IoError.
void writeZip(const std::string& path, const std::vector<ZipSource>&);

} // namespace abbe
