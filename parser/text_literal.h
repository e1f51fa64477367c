// Quoted texts: "…", """…""" and their raw forms #"…"#.
#pragma once

#include "parser/source_text.h"
#include "schema/document.h"

namespace abbe::parser {

struct TextLiteral {
    const char* end = nullptr; // past the closing quote
    std::string_view text;     // decoded; a view of the source where that is the same
    bool lost = false;         // it had no end
};

// Whether a quoted text begins at `p`: a quote, perhaps after some `#`.
bool startsText(const char* p);

// Scans the text at `p` (Requires: startsText(p)). Reports what is wrong and goes on behind it; decoded texts are kept
// in the document.
TextLiteral scanText(const char* p, SyntaxErrors&, schema::Document&);

} // namespace abbe::parser
