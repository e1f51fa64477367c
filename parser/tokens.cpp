#include "parser/tokens.h"

#include "parser/characters.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <vector>

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

namespace {

bool isBlankOrNewline(const char* p, const char* end) { return blankLength(p, end) > 0 || newlineLength(p, end) > 0; }

const char* skipWhite(const char* p, const char* end) {
    while (p < end && isBlankOrNewline(p, end)) p += std::max(blankLength(p, end), newlineLength(p, end));
    return p;
}

// The code point of `\u{…}` at `p` (on the backslash) and the end of the escape; length 0 when it is not one.
CodePoint unicodeEscape(const char* p, const char* end) {
    if (p[1] != 'u' || p[2] != '{') return {};
    const char* const digits = p + 3;
    const char* close = digits;
    while (close < end && close - digits < 7 && *close != '}' && *close != '"') ++close;
    std::uint32_t value = 0;
    const auto [stop, error] = std::from_chars(digits, close, value, 16);
    const bool scalar = value <= 0x10ffff && (value < 0xd800 || value >= 0xe000);
    if (*close != '}' || close == digits || close - digits > 6 || stop != close || error != std::errc{} || !scalar)
        return {};
    return {value, static_cast<std::uint32_t>(close + 1 - p)};
}

char simpleEscape(char c) {
    switch (c) {
    case 'n':
        return '\n';
    case 'r':
        return '\r';
    case 't':
        return '\t';
    case 'b':
        return '\b';
    case 'f':
        return '\f';
    case 's':
        return ' ';
    case '"':
    case '\\':
        return c;
    default:
        return 0;
    }
}

void reportEscape(const char* p, const char* end, SyntaxErrors& errors) {
    if (p[1] == 'u') {
        errors.error("E0115", p, end, "this is not the escape of a Unicode character",
                     "write one to six hexadecimal digits in braces: `\\u{1F600}`");
        return;
    }
    Diagnostic& d = errors.error("E0115", p, end, fmt::format("`{}` is not an escape", between(p, end)),
                                 "write `\\\\` for a backslash");
    d.help = "file names are written with `/` on every system";
    errors.fix(d, p, p + 1, "\\\\");
}

// Reports the escapes in [p, end) that KDL does not know.
void checkEscapes(const char* p, const char* end, SyntaxErrors& errors) {
    while ((p = std::find(p, end, '\\')) != end) {
        const CodePoint unicode = unicodeEscape(p, end);
        if (unicode.length > 0 || isBlankOrNewline(p + 1, end)) {
            p += std::max(unicode.length, 2u);
        } else if (simpleEscape(p[1]) != 0) {
            p += 2;
        } else {
            const std::uint32_t length = std::max(decodeUtf8(p + 1, errors.text().end).length, 1u);
            reportEscape(p, p + 1 + length, errors);
            p += 1 + length;
        }
    }
}

// Resolves escapes; those that checkEscapes() refuses stand for themselves.
std::string decodeEscapes(std::string_view text) {
    const std::string copy(text); // ends with a NUL
    const char* p = copy.c_str();
    const char* const end = p + copy.size();
    std::string decoded;
    while (p < end) {
        const char* const stop = std::find(p, end, '\\');
        decoded.append(p, stop);
        p = stop;
        if (p == end) break;
        if (const CodePoint unicode = unicodeEscape(p, end); unicode.length > 0) {
            appendUtf8(decoded, unicode.value);
            p += unicode.length;
        } else if (const char simple = simpleEscape(p[1]); simple != 0) {
            decoded.push_back(simple);
            p += 2;
        } else {
            const char* const next = skipWhite(p + 1, end);
            if (next == p + 1) decoded.push_back('\\');
            p = next;
        }
    }
    return decoded;
}

// Past the closing quotes of length `quotes` with `hashes` behind them, searched from `p`; null when there are none.
// Single-line texts end at a line end that is not escaped; `stop` then says where.
const char* findClosing(const char* p, const char* end, std::ptrdiff_t quotes, std::ptrdiff_t hashes,
                        const char*& stop) {
    const auto closesAt = [&](const char* at) {
        for (std::ptrdiff_t i = 0; i < quotes; ++i)
            if (at[i] != '"') return false;
        for (std::ptrdiff_t i = 0; i < hashes; ++i)
            if (at[quotes + i] != '#') return false;
        return true;
    };
    while (true) {
        while (!has(*p, kStringStop)) ++p;
        if (p >= end) break;
        if (*p == '"' && closesAt(p)) return p + quotes + hashes;
        if (*p == '\\' && hashes == 0) {
            const char* const white = skipWhite(p + 1, end);
            p = white > p + 1 ? white : std::min(p + 2, end);
        } else if (quotes == 1 && newlineLength(p, end) > 0) {
            break;
        } else {
            ++p;
        }
    }
    stop = std::min(p, end);
    return nullptr;
}

// A text that has no end on its line. Where a block opens or closes later on the line, the text is taken to end before
// it, so that one forgotten quote does not also unbalance the braces.
TextLiteral recoverLine(const char* open, const char* body, const char* stop, SyntaxErrors& errors) {
    const char* cut = std::find_if(body, stop, [](char c) { return c == ';' || c == '{' || c == '}'; });
    while (cut > body && has(cut[-1], kBlank)) --cut;
    const bool raw = *open == '#';
    errors.error("E0103", open, body, "this text has no end",
                 raw ? fmt::format("no `{}` before the end of the line", "\"" + std::string(open, body - 1))
                     : "no `\"` before the end of the line");
    return {cut, between(body, cut), true};
}

// Whether an odd number of quotes stands on the line from `p` on: then one of them is missing.
bool hasOddQuotes(const char* p, const char* end) {
    bool odd = false;
    for (const char* const line = findNearLineEnd(p, end); p < line; ++p) {
        if (*p == '\\' && p + 1 < line)
            ++p;
        else if (*p == '"')
            odd = !odd;
    }
    return odd;
}

struct Line {
    std::string text;
    const char* source;
};

// The lines of a text of several lines, continued ones joined, other escapes untouched.
std::vector<Line> splitLines(const char* p, const char* end, bool raw) {
    std::vector<Line> lines{{{}, p}};
    while (p < end) {
        if (const std::uint32_t newline = newlineLength(p, end); newline > 0) {
            p += newline;
            lines.push_back({{}, p});
        } else if (*p == '\\' && !raw) {
            const char* const white = skipWhite(p + 1, end);
            if (white == p + 1) lines.back().text.append(p, std::min(p + 2, end));
            p = white == p + 1 ? std::min(p + 2, end) : white;
        } else {
            lines.back().text.push_back(*p++);
        }
    }
    return lines;
}

std::size_t leadingBlanks(const std::string& text) {
    const char* const end = text.c_str() + text.size();
    const char* p = text.c_str();
    while (p < end && blankLength(p, end) > 0) p += blankLength(p, end);
    return static_cast<std::size_t>(p - text.c_str());
}

// Removes the indentation of the closing quotes from every line and joins the lines.
std::string dedent(std::vector<Line> lines, const char* closing, const char* end, SyntaxErrors& errors) {
    const std::size_t last = lines.size() - 1;
    const std::string prefix = lines[last].text.substr(0, leadingBlanks(lines[last].text));
    const bool alone = prefix.size() == lines[last].text.size();
    if (!alone)
        errors.error("E0116", closing, end,
                     "the closing quotes of a text of several lines stand on a line of their own",
                     "begin a new line before them");
    bool reported = !alone;
    std::string joined;
    for (std::size_t i = 0; i < lines.size() - (alone ? 1 : 0); ++i) {
        const std::string& text = lines[i].text;
        if (i > 0) joined.push_back('\n');
        const std::size_t indent = leadingBlanks(text);
        if (indent == text.size()) continue;
        const bool fits = text.starts_with(prefix);
        if (!fits && !reported) {
            const char* const first = lines[i].source;
            errors
                .error("E0116", first, first + std::max<std::size_t>(indent, 1),
                       "this line is indented less than the closing quotes of its text",
                       "must begin with the same white space")
                .related.push_back({errors.text().span(closing, end), "the closing quotes"});
            reported = true;
        }
        joined.append(text, fits ? prefix.size() : indent, std::string::npos);
    }
    return joined;
}

// `"""` that is not followed by a line end.
void reportSameLine(const char* open, const char* body, const char* close, SyntaxErrors& errors, bool raw) {
    Diagnostic& d = errors.error("E0116", open, body, "a text of several lines begins on the line after its quotes",
                                 "a line end must follow");
    const bool single = findNearLineEnd(body, close) == close && std::find(body, close, '"') == close;
    if (!single || raw) return;
    d.help = "a text of one line has one quote on each side";
    errors.fix(d, open, close + 3, fmt::format("\"{}\"", between(body, close)));
}

TextLiteral scanSeveralLines(const char* open, const char* body, std::ptrdiff_t hashes, SyntaxErrors& errors,
                             schema::Document& document) {
    const char* const end = errors.text().end;
    const char* stop = nullptr;
    const char* const after = findClosing(body, end, 3, hashes, stop);
    if (after == nullptr) {
        errors.error("E0103", open, body, "this text has no end", "no closing quotes before the end of the file");
        errors.markCutOff();
        return {end, between(body, end), true};
    }
    const char* const close = after - 3 - hashes;
    const bool raw = hashes > 0;
    if (!raw) checkEscapes(body, close, errors);
    const std::uint32_t newline = newlineLength(body, end);
    std::string text;
    if (newline == 0) {
        reportSameLine(open, body, close, errors, raw);
        text = std::string(body, close);
    } else {
        text = dedent(splitLines(body + newline, close, raw), close, after, errors);
    }
    return {after, document.intern(raw ? std::move(text) : decodeEscapes(text)), false};
}

} // namespace

bool startsText(const char* p) {
    while (*p == '#') ++p;
    return *p == '"';
}

TextLiteral scanText(const char* p, SyntaxErrors& errors, schema::Document& document) {
    const char* const open = p;
    while (*p == '#') ++p;
    const std::ptrdiff_t hashes = p - open;
    if (p[1] == '"' && p[2] == '"') return scanSeveralLines(open, p + 3, hashes, errors, document);
    const char* const body = p + 1;
    const char* stop = nullptr;
    const char* const after = findClosing(body, errors.text().end, 1, hashes, stop);
    if (after == nullptr) return recoverLine(open, body, stop, errors);
    // `"foo { b "c" }`: the text runs into the next one, whose opening quote seemed to close it.
    if (hashes == 0 && has(*after, kWord) && hasOddQuotes(open, errors.text().end))
        return recoverLine(open, body, findLineEnd(body, errors.text().end), errors);
    const std::string_view text = between(body, after - 1 - hashes);
    if (hashes > 0 || text.find('\\') == std::string_view::npos) return {after, text, false};
    checkEscapes(body, after - 1, errors);
    return {after, document.intern(decodeEscapes(text)), false};
}

namespace {

TokenKind markKind(char c) {
    switch (c) {
    case '{':
        return TokenKind::open;
    case '}':
        return TokenKind::close;
    case ';':
        return TokenKind::semicolon;
    case '=':
        return TokenKind::equals;
    case '(':
        return TokenKind::openType;
    case ')':
        return TokenKind::closeType;
    case '\\':
        return TokenKind::continuation;
    default:
        return TokenKind::other;
    }
}

} // namespace

Token nextToken(const char* p, SyntaxErrors& errors, schema::Document& document) {
    const char* const end = errors.text().end;
    if (p == end) return {TokenKind::end, p, p};
    if (const char* const word = wordEnd(p, end); word > p) return {TokenKind::word, p, word};
    if (const std::uint32_t newline = newlineLength(p, end)) return {TokenKind::lineEnd, p, p + newline};
    if (blankLength(p, end) > 0) {
        const char* q = p;
        while (const std::uint32_t blank = blankLength(q, end)) q += blank;
        return {TokenKind::blank, p, q};
    }
    if (*p == '/') {
        if (p[1] == '/') return {TokenKind::lineComment, p, findLineEnd(p, end)};
        if (p[1] == '*') return {TokenKind::blockComment, p, skipComment(p, errors)};
        if (p[1] == '-') return {TokenKind::slashdash, p, p + 2};
    }
    if (startsText(p)) return {TokenKind::text, p, scanText(p, errors, document).end};
    if (*p == '#') return {TokenKind::word, p, wordEnd(p + 1, end)};
    const std::uint32_t length = std::max(decodeUtf8(p, end).length, 1u);
    return {markKind(*p), p, p + length};
}

} // namespace abbe::parser
