// What stands between the nodes and values of a KDL text, its quoted texts, and all of it token by token.
#pragma once

#include "parser/characters.h"
#include "parser/source_text.h"
#include "schema/document.h"

namespace abbe::parser {

// White space of KDL: between the entries of a node, and between nodes.

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

// Quoted texts: "…", """…""" and their raw forms #"…"#.

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

// Tokens: the text without a gap, for what has to write it again. The tree is read without them, by the same functions.

enum class TokenKind : std::uint8_t {
    end,          // of the text; empty
    blank,        // white space up to the next token
    lineEnd,      // one
    lineComment,  // from `//`, without the line end
    blockComment, // with all that are inside it
    continuation, // a `\` alone; what follows up to the line end is tokens of its own
    slashdash,
    open,  // {
    close, // }
    semicolon,
    equals,
    openType,  // (
    closeType, // )
    text,      // a quoted text, with its quotes
    word,      // a bare word, a number or a keyword with its `#`
    other      // one character that has no meaning there
};

struct Token {
    TokenKind kind = TokenKind::end;
    const char* begin = nullptr;
    const char* end = nullptr;

    std::string_view text() const { return between(begin, end); }
};

// The token that begins at `p`. Reports what is wrong inside of it alone; decoded texts are kept in the document.
Token nextToken(const char* p, SyntaxErrors&, schema::Document&);

} // namespace abbe::parser
