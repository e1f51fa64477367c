#include "base/text.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// A byte that is no UTF-8 stands for itself.
constexpr std::uint32_t kNoUtf8 = 0xffffffff;

CodePoint firstOf(std::string_view text) {
    const CodePoint c = decodeUtf8(text.data(), text.data() + text.size());
    return c.length > 0 ? c : CodePoint{kNoUtf8, 1};
}

bool isControl(std::uint32_t c) {
    return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069) || c == 0xfeff || c == kNoUtf8;
}

std::string shown(std::string_view text, bool lines) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const CodePoint c = firstOf(text);
        if (c.value == kNoUtf8)
            out += "\xef\xbf\xbd";
        else if (isControl(c.value) && !(lines && (c.value == '\n' || c.value == '\t')))
            out += fmt::format("\\u{:04x}", c.value);
        else
            out += text.substr(0, c.length);
        text.remove_prefix(c.length);
    }
    return out;
}

} // namespace

FirstCharacter firstCharacter(std::string_view text) {
    const CodePoint c = firstOf(text);
    return {c.length, isControl(c.value)};
}

std::string shownLine(std::string_view text) { return shown(text, false); }

std::string shownLines(std::string_view text) { return shown(text, true); }

std::string jsonText(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (c == '\n')
            out += "\\n";
        else
            out += c;
    }
    return "\"" + shownLine(out) + "\"";
}

bool sameName(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; };
    return std::ranges::equal(a, b, [&](char p, char q) { return lower(p) == lower(q); });
}

} // namespace abbe
