// Classes of characters in KDL 2.0.0: one table for single bytes, one function for the few wide ones that matter.
#pragma once

#include "base/text.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace abbe::parser {

// Properties of a byte; several may hold.
enum CharacterBits : std::uint8_t {
    kWord = 1,        // may stand inside a bare word
    kBlank = 2,       // space, tab; control characters too, which are reported once, before scanning
    kNewline = 4,     // line feed, carriage return, vertical tab, form feed
    kDigit = 8,       // 0 … 9
    kWide = 16,       // first byte of a code point that may be white space or a line end: ask wideKind()
    kStringStop = 32, // a quoted text cannot simply run over it
    kValueEnd = 64    // may follow a value at once: white space, line end, `;`, `}`, line continuation, end of text
};

constexpr std::array<std::uint8_t, 256> makeCharacterTable() {
    std::array<std::uint8_t, 256> table{};
    for (unsigned c = 0; c < 256; ++c) {
        std::uint8_t bits = kWord;
        if (c < 0x20 || c == 0x7f || c == ' ') bits = kBlank;
        if (c == '\n' || c == '\r' || c == '\v' || c == '\f') bits = kNewline | kStringStop;
        if (c >= '0' && c <= '9') bits = kWord | kDigit;
        for (const char special : std::string_view{"(){}[]/\\\"#;="})
            if (c == static_cast<unsigned char>(special)) bits = 0;
        if (c == ',') bits = 0; // KDL allows it inside words, the scene language does not: see E0112
        if (c == '"' || c == '\\') bits |= kStringStop;
        if ((bits & (kBlank | kNewline)) != 0 || c == ';' || c == '}' || c == '\\') bits |= kValueEnd;
        if (c == 0) bits = kStringStop | kValueEnd; // the end of the text, or a NUL inside it
        if (c == 0xc2 || c == 0xe1 || c == 0xe2 || c == 0xe3 || c == 0xef) bits = kWide;
        if (c == 0xc2 || c == 0xe2) bits |= kStringStop;
        table[c] = bits;
    }
    return table;
}
inline constexpr std::array<std::uint8_t, 256> kCharacters = makeCharacterTable();

inline bool has(char c, unsigned bits) { return (kCharacters[static_cast<unsigned char>(c)] & bits) != 0; }
inline bool isDigit(char c) { return c >= '0' && c <= '9'; }

enum class Wide : std::uint8_t { word, blank, newline, disallowed };

void appendUtf8(std::string& text, std::uint32_t codePoint);

// What the code point `c` is to KDL.
Wide wideKind(std::uint32_t c);

// Length in bytes of the line end at `p` (CR LF is one), or 0. The text ends with a NUL at `end`.
std::uint32_t newlineLength(const char* p, const char* end);
// Length in bytes of the white space character at `p`, or 0.
std::uint32_t blankLength(const char* p, const char* end);
// Whether a character that may stand in a bare word is at `p`.
bool isWordCharacter(const char* p, const char* end);
// Past the characters of a bare word that begin at `p`.
const char* wordEnd(const char* p, const char* end);

} // namespace abbe::parser
