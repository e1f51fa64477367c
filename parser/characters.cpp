#include "parser/characters.h"

namespace abbe::parser {

void appendUtf8(std::string& text, std::uint32_t c) {
    const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
    if (c < 0x80) {
        put(c);
    } else if (c < 0x800) {
        put(0xc0 | c >> 6);
        put(0x80 | (c & 0x3f));
    } else if (c < 0x10000) {
        put(0xe0 | c >> 12);
        put(0x80 | (c >> 6 & 0x3f));
        put(0x80 | (c & 0x3f));
    } else {
        put(0xf0 | c >> 18);
        put(0x80 | (c >> 12 & 0x3f));
        put(0x80 | (c >> 6 & 0x3f));
        put(0x80 | (c & 0x3f));
    }
}

Wide wideKind(std::uint32_t c) {
    if (c == 0x85 || c == 0x2028 || c == 0x2029 || c == 0x0a || c == 0x0b || c == 0x0c || c == 0x0d)
        return Wide::newline;
    if (c == 0x09 || c == 0x20 || c == 0xa0 || c == 0x1680 || (c >= 0x2000 && c <= 0x200a) || c == 0x202f ||
        c == 0x205f || c == 0x3000)
        return Wide::blank;
    if (c < 0x20 || c == 0x7f || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
        (c >= 0x2066 && c <= 0x2069) || c == 0xfeff)
        return Wide::disallowed;
    return Wide::word;
}

std::uint32_t newlineLength(const char* p, const char* end) {
    if (*p == '\r') return p[1] == '\n' ? 2 : 1;
    if (has(*p, kNewline)) return 1;
    if (!has(*p, kWide)) return 0;
    const CodePoint c = decodeUtf8(p, end);
    return c.length > 0 && wideKind(c.value) == Wide::newline ? c.length : 0;
}

std::uint32_t blankLength(const char* p, const char* end) {
    if (has(*p, kBlank)) return 1;
    if (*p == 0) return p < end ? 1 : 0; // a NUL in the text: reported already
    if (!has(*p, kWide)) return 0;
    const CodePoint c = decodeUtf8(p, end);
    if (c.length == 0) return 0;
    const Wide kind = wideKind(c.value);
    return kind == Wide::blank || kind == Wide::disallowed ? c.length : 0;
}

bool isWordCharacter(const char* p, const char* end) {
    if (!has(*p, kWide)) return has(*p, kWord);
    const CodePoint c = decodeUtf8(p, end);
    return c.length > 0 && wideKind(c.value) == Wide::word;
}

const char* wordEnd(const char* p, const char* end) {
    for (;;) {
        while (has(*p, kWord)) ++p;
        if (!has(*p, kWide)) return p;
        const CodePoint c = decodeUtf8(p, end);
        if (c.length == 0 || wideKind(c.value) != Wide::word) return p;
        p += c.length;
    }
}

} // namespace abbe::parser
