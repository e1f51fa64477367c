// A text as its lines and the braces in them: what indentation says about blocks, where the braces do not agree.
#pragma once

#include "parser/source_text.h"

#include <string_view>
#include <vector>

namespace abbe::parser {

// A brace or bracket outside of texts and comments.
struct BraceToken {
    const char* at;
    char kind; // { } ( ) [ ]
};

// A line that holds more than comments and does not begin inside of a text or comment.
struct BraceLine {
    const char* first = nullptr;         // its first character behind the indentation
    const char* last = nullptr;          // its last one before a comment
    std::ptrdiff_t indent = 0;           // characters before `first`
    std::vector<BraceToken> tokens = {}; // from left to right
    bool continued = false;              // ends in `\`

    std::string_view word() const; // the bare word that it begins with; empty if it does not
    std::string_view text() const { return between(first, last + 1); }
    bool ends(char c) const { return *last == c; }
    bool is(char c) const { return first == last && *first == c; } // nothing else stands in it
    // How many of its own opening braces stay open, and how many closing ones close an earlier line's.
    std::ptrdiff_t opened() const;
    std::ptrdiff_t closed() const;
};

// Nothing where a text or comment has no end: what belongs to which line is then anybody's guess.
std::vector<BraceLine> braceLines(const SourceText&);

} // namespace abbe::parser
