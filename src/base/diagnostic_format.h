// Diagnostics as text: with excerpts for people, one line each for editors, JSON for programs.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"

#include <cstddef>
#include <string>

namespace abbe {

struct FormatOptions {
    bool color = false;         // ANSI colours
    std::size_t maxErrors = 20; // at most so many errors, and so many warnings, are shown; the others are counted
    std::string summaryName;    // begins the last line; empty: the path of the first diagnostic's file
};

// Every diagnostic with its place, an excerpt and carets, sorted by file and position; the last line counts them. Empty
// when there is none.
std::string formatHuman(const Diagnostics&, const SourceMap&, const FormatOptions& = {});

// `path:line:column: error[E0105]: text (label)`, one line each, sorted.
std::string formatShort(const Diagnostics&, const SourceMap&);

// A JSON array, sorted, whose objects have the fields of an LSP Diagnostic (lines and UTF-16 characters from 0) and
// `path`; `data` holds label, notes, help and fixes.
std::string formatJson(const Diagnostics&, const SourceMap&);

} // namespace abbe
