#include "parser/source_text.h"

#include "parser/characters.h"

#include <cstring>
#include <fmt/format.h>

namespace abbe::parser {

Diagnostic& SyntaxErrors::error(const char* code, const char* from, const char* to, std::string message,
                                std::string label) {
    ++count_;
    if (count_ <= kMost) return diagnostics_.error(code, text_.span(from, to), std::move(message), std::move(label));
    if (count_ == kMost + 1)
        diagnostics_.error("E0199", text_.span(from, to),
                           fmt::format("more than {} syntax errors; the rest is not listed", kMost));
    return unlisted_ = Diagnostic{};
}

void SyntaxErrors::fix(Diagnostic& diagnostic, const char* from, const char* to, std::string replacement) const {
    diagnostic.fixes.push_back({text_.span(from, to), std::move(replacement)});
}

namespace {

// Whether a block of 64 bytes is printable ASCII and line ends alone; compilers make vector code of it.
bool isPlainBlock(const char* p) {
    unsigned odd = 0;
    for (int i = 0; i < 64; ++i) {
        const auto c = static_cast<signed char>(p[i]); // bytes above 127 are negative
        const bool plain = (c >= 0x20 && c != 0x7f) || (c >= 0x09 && c <= 0x0d);
        odd |= static_cast<unsigned>(!plain);
    }
    return odd == 0;
}

enum class Found : std::uint8_t { nothing, disallowed, broken };

struct Finding {
    Found what = Found::nothing;
    const char* at = nullptr;
};

// The first character at or after `p` that may not stand in a text, or the first byte that is not UTF-8; disallowed
// characters are passed over if only broken encoding is looked for.
Finding findOdd(const char* p, const char* end, bool onlyBroken) {
    while (p < end) {
        while (end - p >= 64 && isPlainBlock(p)) p += 64;
        if (p == end) break;
        const CodePoint c = decodeUtf8(p, end);
        if (c.length == 0) return {Found::broken, p};
        if (!onlyBroken && wideKind(c.value) == Wide::disallowed) return {Found::disallowed, p};
        p += c.length;
    }
    return {};
}

void reportNotUtf8(SyntaxErrors& errors, const char* at) {
    const SourceText& text = errors.text();
    Diagnostic& d = errors.error("E0412", at, at + 1, "the file is not UTF-8 text",
                                 fmt::format("byte {:#04x}", static_cast<unsigned char>(*at)));
    const bool utf16 = text.end - text.begin >= 2 &&
                       (std::memcmp(text.begin, "\xff\xfe", 2) == 0 || std::memcmp(text.begin, "\xfe\xff", 2) == 0);
    d.help = utf16 ? "this looks like UTF-16; save the file as UTF-8" : "save the file as UTF-8";
}

} // namespace

bool checkUtf8(SyntaxErrors& errors) {
    const Finding finding = findOdd(errors.text().begin, errors.text().end, true);
    if (finding.what == Found::broken) reportNotUtf8(errors, finding.at);
    return finding.what != Found::broken;
}

bool checkCharacters(SyntaxErrors& errors) {
    const SourceText& text = errors.text();
    const bool marked = text.end - text.begin >= 3 && std::memcmp(text.begin, "\xef\xbb\xbf", 3) == 0;
    const char* p = text.begin + (marked ? 3 : 0); // a byte order mark may come first
    Finding finding = findOdd(p, text.end, false);
    if (finding.what == Found::nothing) return true;
    if (!checkUtf8(errors)) return false;
    while (finding.what == Found::disallowed) {
        const std::uint32_t value = decodeUtf8(finding.at, text.end).value;
        const char* next = finding.at; // a run of such characters is one error
        while (next < text.end && wideKind(decodeUtf8(next, text.end).value) == Wide::disallowed)
            next += decodeUtf8(next, text.end).length;
        errors.error("E0102", finding.at, next,
                     fmt::format("the character U+{:04X} may not stand in a scene file", value),
                     "remove it, or write it as an escape inside a quoted text");
        finding = findOdd(next, text.end, false);
    }
    return true;
}

} // namespace abbe::parser
