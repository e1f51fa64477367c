// UTF-8 text: its characters, and what terminals and JSON may be given of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace abbe {

struct CodePoint {
    std::uint32_t value = 0;
    std::uint32_t length = 0; // bytes; 0: not well-formed UTF-8
};

// The code point at `p`, which is before `end`. Refuses surrogates, overlong forms and values above 10FFFF
// [Unicode, table 3-7].
inline CodePoint decodeUtf8(const char* p, const char* end) {
    const auto byte = [&](int i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(p[i])); };
    const std::uint32_t lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    const std::uint32_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || end - p < static_cast<std::ptrdiff_t>(length)) return {};
    std::uint32_t value = lead & (0x7fu >> length);
    for (std::uint32_t i = 1; i < length; ++i) {
        if ((byte(static_cast<int>(i)) & 0xc0u) != 0x80u) return {};
        value = value << 6 | (byte(static_cast<int>(i)) & 0x3fu);
    }
    const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
    const bool surrogate = value >= 0xd800 && value < 0xe000;
    if (overlong || surrogate || value > 0x10ffff) return {};
    return {value, length};
}

// Of a text that is not empty. Controls are what a terminal would obey instead of showing it: control characters (C0,
// DEL, C1), those that change the direction of writing, the byte order mark, and bytes that are no UTF-8.
struct FirstCharacter {
    std::size_t bytes = 1;
    bool control = false;
};
FirstCharacter firstCharacter(std::string_view text);

// The text with controls as `\u001b`, which is what JSON has in their place, too; bytes that are no UTF-8 as
// U+FFFD. Line ends and tabs go with the others, or stay where the text has several lines of its own.
std::string shownLine(std::string_view text);
std::string shownLines(std::string_view text);

// In quotes, with what JSON or a terminal would stumble over escaped; bytes that are no UTF-8 become U+FFFD.
std::string jsonText(std::string_view);

// Comparison of the names of library data.
// Equal but for the case of ASCII letters.
bool sameName(std::string_view a, std::string_view b);

} // namespace abbe
