// Where in which file something was written. Spans travel from the scanner to the last diagnostic.
#pragma once

#include <cstdint>

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

} // namespace abbe
