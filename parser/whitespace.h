// White space of KDL: between the entries of a node, and between nodes.
#pragma once

#include "parser/characters.h"
#include "parser/source_text.h"

namespace abbe::parser {

// Slow cases of the functions below.
const char* skipOddNodeSpace(const char* p, SyntaxErrors&, bool& lineComment);

// Skips white space, block comments and continued lines. `lineComment` is set when a `//` after a `\` was among them.
inline const char* skipNodeSpace(const char* p, SyntaxErrors& errors, bool& lineComment) {
    while (*p == ' ' || *p == '\t') ++p;
    const bool odd = *p == '/' || *p == '\\' || *p == 0 || has(*p, kBlank | kWide);
    return odd ? skipOddNodeSpace(p, errors, lineComment) : p;
}

// Skips everything that may stand between nodes but `;` and slashdashes: also line ends and line comments.
const char* skipLineSpace(const char* p, SyntaxErrors&);

// To the line end at or after `p`, or to the end of the text.
const char* findLineEnd(const char* p, const char* end);
// The same, but at most 200 bytes on: where a mistake is looked at, so that many of them on one very long line
// take no quadratic time.
const char* findNearLineEnd(const char* p, const char* end);
// To the first character of the line of `p`.
const char* findLineStart(const char* p, const char* begin);

} // namespace abbe::parser
