#include "base/shown_text.h"

#include <fmt/format.h>

namespace abbe {

namespace {

constexpr char32_t kNoUtf8 = 0xffffffff;

struct Character {
    char32_t code = 0;
    std::size_t bytes = 1;
};

// Well-formed sequences alone [Unicode, table 3-7], or the first byte.
Character decode(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    constexpr Character kNone{kNoUtf8, 1};
    const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return kNone;
    char32_t code = lead & (0x7fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0u) != 0x80u) return kNone;
        code = code << 6 | (byte(i) & 0x3fu);
    }
    constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < kLeast[bytes] || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) return kNone;
    return {code, bytes};
}

bool isControl(char32_t c) {
    return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069) || c == 0xfeff || c == kNoUtf8;
}

std::string shown(std::string_view text, bool lines) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const Character c = decode(text);
        if (c.code == kNoUtf8)
            out += "\xef\xbf\xbd";
        else if (isControl(c.code) && !(lines && (c.code == '\n' || c.code == '\t')))
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(c.code));
        else
            out += text.substr(0, c.bytes);
        text.remove_prefix(c.bytes);
    }
    return out;
}

} // namespace

FirstCharacter firstCharacter(std::string_view text) {
    const Character c = decode(text);
    return {c.bytes, isControl(c.code)};
}

std::string shownLine(std::string_view text) { return shown(text, false); }

std::string shownLines(std::string_view text) { return shown(text, true); }

} // namespace abbe
