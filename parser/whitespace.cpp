#include "parser/whitespace.h"

namespace abbe::parser {

namespace {

// Past the block comment that opens at `p`; comments nest.
const char* skipComment(const char* p, SyntaxErrors& errors) {
    const char* const end = errors.text().end;
    const char* const open = p;
    const char* inner = p;
    int depth = 0;
    while (p < end) {
        if (p[0] == '/' && p[1] == '*') {
            ++depth;
            inner = p;
            p += 2;
        } else if (p[0] == '*' && p[1] == '/') {
            p += 2;
            if (--depth == 0) return p;
        } else {
            ++p;
        }
    }
    Diagnostic& d = errors.error("E0104", open, open + 2, "this comment has no end", "no matching `*/`");
    if (inner != open) d.related.push_back({errors.text().span(inner, inner + 2), "a comment inside it opens here"});
    errors.markCutOff();
    return end;
}

// Past a `\` that continues the line; a `\` before anything but a line end is an error and skipped alone.
const char* skipContinuation(const char* p, SyntaxErrors& errors, bool& lineComment) {
    const char* const end = errors.text().end;
    const char* q = p + 1;
    for (;;) {
        if (const std::uint32_t blank = blankLength(q, end)) {
            q += blank;
        } else if (q[0] == '/' && q[1] == '*') {
            q = skipComment(q, errors);
        } else {
            break;
        }
    }
    if (q[0] == '/' && q[1] == '/') {
        lineComment = true;
        q = findLineEnd(q, end);
    }
    if (q == end) return q;
    if (const std::uint32_t newline = newlineLength(q, end)) return q + newline;
    Diagnostic& d =
        errors.error("E0101", p, p + 1, "`\\` has no meaning here", "it continues a line only at the line's end");
    d.help = "write file names with `/`";
    return p + 1;
}

} // namespace

const char* findLineEnd(const char* p, const char* end) {
    while (p < end && (!has(*p, kNewline | kWide) || newlineLength(p, end) == 0)) ++p;
    return p;
}

const char* findNearLineEnd(const char* p, const char* end) { return findLineEnd(p, end - p > 200 ? p + 200 : end); }

const char* findLineStart(const char* p, const char* begin) {
    while (p > begin && !has(p[-1], kNewline)) --p;
    return p;
}

const char* skipOddNodeSpace(const char* p, SyntaxErrors& errors, bool& lineComment) {
    const char* const end = errors.text().end;
    for (;;) {
        if (*p == '\\') {
            p = skipContinuation(p, errors, lineComment);
        } else if (p[0] == '/' && p[1] == '*') {
            p = skipComment(p, errors);
        } else if (const std::uint32_t blank = blankLength(p, end)) {
            p += blank;
        } else {
            return p;
        }
    }
}

const char* skipLineSpace(const char* p, SyntaxErrors& errors) {
    const char* const end = errors.text().end;
    bool lineComment = false;
    for (;;) {
        while (*p == ' ' || *p == '\n' || *p == '\t' || *p == '\r') ++p;
        p = skipNodeSpace(p, errors, lineComment);
        if (const std::uint32_t newline = newlineLength(p, end)) {
            p += newline;
        } else if (p[0] == '/' && p[1] == '/') {
            p = findLineEnd(p, end);
        } else {
            return p;
        }
    }
}

} // namespace abbe::parser
