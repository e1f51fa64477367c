// Where in which file something was written, and the texts of all files that were read: spans travel from the scanner
// to the last diagnostic, which shows them as line, column and excerpt.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// Index of a file in a SourceMap; `none` marks things that no file asked for (command line, defaults).
enum class FileId : std::uint32_t { none = 0xffffffffu };

// Half-open byte range [begin, end) of one file.
struct Span {
    FileId file = FileId::none;
    std::uint32_t begin = 0;
    std::uint32_t end = 0;

    bool valid() const { return file != FileId::none; }
    friend bool operator==(const Span&, const Span&) = default;
};

// The smallest span that holds both; both lie in one file.
inline Span join(Span a, Span b) {
    if (!a.valid()) return b;
    if (!b.valid()) return a;
    return {a.file, a.begin < b.begin ? a.begin : b.begin, a.end > b.end ? a.end : b.end};
}

// Lines and columns count from 1; columns count characters (UTF-8 code points), not bytes.
struct LineColumn {
    std::uint32_t line = 0;
    std::uint32_t column = 0;
};

// Owns paths and texts; texts never move, so string_views into them stay valid for the map's lifetime.
// Not thread-safe while files are being added.
class SourceMap {
  public:
    // Takes a text that is in memory already. `path` is shown as given.
    FileId add(std::string path, std::string text);

    std::string_view path(FileId) const;
    std::string_view text(FileId) const;
    std::string_view text(Span) const;
    LineColumn lineColumn(FileId, std::uint32_t offset) const;
    // Characters in UTF-16 units between the beginning of its line and `offset`, as editors count them.
    std::uint32_t utf16Column(FileId, std::uint32_t offset) const;
    // The text of a line (from 1) without its line end.
    std::string_view line(FileId, std::uint32_t line) const;
    std::size_t fileCount() const { return files_.size(); }

  private:
    // Characters of a text before a place.
    struct Characters {
        std::uint32_t points = 0; // code points
        std::uint32_t units = 0;  // of UTF-16
    };
    struct File {
        std::string path;
        std::string text;
        mutable std::vector<std::uint32_t> lineStarts; // made on first use
        mutable std::vector<Characters> marks;         // likewise: before each block of kBlock bytes
    };
    static constexpr std::size_t kBlock = 1024;
    const std::vector<std::uint32_t>& lineStarts(FileId) const;
    // In a time that does not depend on the lengths of lines: thousands of faults may stand on one.
    Characters charactersBefore(FileId, std::size_t offset) const;
    std::deque<File> files_;
};

} // namespace abbe
