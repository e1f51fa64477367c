// One line of a source text with carets and dashes under its parts.
#pragma once

#include "base/diagnostic.h"
#include "base/source_map.h"

#include <string>
#include <vector>

namespace abbe {

// A part of the line: `^` for the primary one, `-` for others.
struct Underline {
    Span span;
    std::string label;
    bool primary = false;
};

struct Excerpt {
    std::string source;              // the line as shown: tabs as spaces, very long lines cut around the primary part
    std::vector<std::string> below;  // the lines under it
    std::vector<Underline> notShown; // parts outside of what was cut out
};

// Requires: all parts begin on the line of `primary` and lie in its file.
Excerpt makeExcerpt(const SourceMap&, const Underline& primary, const std::vector<Underline>& others);

} // namespace abbe
